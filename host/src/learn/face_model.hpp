// face_model.hpp - what is learned of faces, and the file that it is kept in (docs/model_format.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "facezip/geometry/shape_regression.hpp"
#include "facezip/progress.hpp"
#include "learn/texture_regression.hpp"
#include "rig/rig_template.hpp"

namespace facezip::learn {

/// Components further from the mean than this (in standard deviations) are cut: a straight line says nothing there.
inline constexpr double kMostScore = 3.0;

/// Meshes are in millimetres, in one frame.
struct FaceModel {
  std::string name;                    ///< of the library
  geometry::TriangleMesh skin;         ///< mean neutral; topology and layout that a subject must have
  rig::RigTemplate face_template;      ///< of the skin, and of parts beyond it
  geometry::ShapeRegression shapes;    ///< of the M shapes; its mean is the skin
  std::vector<TextureModel> textures;  ///< by map
};

/// Returns the bytes of the file. Throws OutputError.
std::uint64_t writeModel(const std::filesystem::path& file, const FaceModel& model, Progress& progress);

/// Reads and checks all of a file, which may come from anywhere. Throws InputError naming the block that is wrong.
FaceModel readModel(const std::filesystem::path& file);

}  // namespace facezip::learn
