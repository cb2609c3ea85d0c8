// registration_template.hpp - the topology and layout that scans are brought into, from disk.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "register/landmark_files.hpp"

namespace facezip::registration {

struct RegistrationTemplate {
  std::filesystem::path neutral_file;
  geometry::TriangleMesh neutral;        ///< with UVs; in the template's own unit
  std::vector<Eigen::MatrixX3d> shapes;  ///< displacements of expressions, any number
  std::vector<Eigen::MatrixX3d>
      identity;  ///< displacements of one standard deviation of each identity mode, any number
  TemplateLandmarks landmarks;
  std::vector<int> region;  ///< triangles whose textures are wanted; empty: what the neutral's scan shows
};

/// Reads DIR/neutral.obj (or generic_neutral.obj), DIR/landmarks.json, every other DIR/NAME.obj as a shape,
/// DIR/identity/NAME.obj as identity modes and DIR/face_region.txt where there are any.
/// Throws InputError: no directory, no or two neutrals, no UVs or such outside [0, 1], no or bad landmarks, a shape or
/// mode of another topology than the neutral.
RegistrationTemplate readRegistrationTemplate(const std::filesystem::path& directory);

}  // namespace facezip::registration
