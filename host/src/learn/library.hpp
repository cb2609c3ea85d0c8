// library.hpp - captures of many people, and what they were asked to perform.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/length.hpp"
#include "facezip/geometry/mesh.hpp"
#include "facezip/progress.hpp"
#include "rig/rig_template.hpp"

namespace facezip::learn {

/// Captures of one topology and layout, each with the same expressions.
struct Library {
  std::filesystem::path directory;
  std::vector<Capture> subjects;         ///< at least two
  std::vector<std::string> expressions;  ///< N, of each
  std::vector<std::string> maps;         ///< that every subject has
  Eigen::MatrixXd asked;                 ///< N by M
};

/// Opens every directory in `library`, or in its folder `subjects` where it has one. Hidden ones are left out.
/// maps  to take; empty: those that every subject has
/// Throws InputError: no or one subject, one whose expressions are others than the first's (which), what openCapture()
/// throws, a file of asked weights as rig::readGuess() refuses it.
Library openLibrary(const std::filesystem::path& directory, const std::filesystem::path& facs,
                    const std::vector<std::string>& shapes, const std::vector<std::string>& maps, Progress& progress);

/// Meshes of one subject in millimetres, turned and shifted as a whole so that its neutral lies as `frame` does.
struct SubjectMeshes {
  geometry::TriangleMesh neutral;               ///< positions in the frame
  std::vector<Eigen::MatrixX3f> displacements;  ///< N, from the neutral
};

/// Unit of a capture's meshes: `unit`, or what the capture states, or a guess from the neutral. Throws InputError.
geometry::LengthUnit unitOf(const Capture& capture, const geometry::TriangleMesh& neutral, const std::string& unit,
                            Progress& progress);

/// frame  #V by 3, millimetres; empty: the neutral stays where it is
/// like   topology and layout that the neutral must have, with its file for messages; may be null
/// Throws InputError.
SubjectMeshes readMeshes(const Capture& capture, const Eigen::MatrixX3d& frame, const geometry::TriangleMesh* like,
                         const std::string& like_file, Progress& progress);

}  // namespace facezip::learn
