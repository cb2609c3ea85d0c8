// texture_learning.hpp - the textures of a library, as regressions.
#pragma once

#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "facezip/geometry/shape_regression.hpp"
#include "facezip/learn.hpp"
#include "facezip/progress.hpp"
#include "learn/library.hpp"
#include "learn/texture_regression.hpp"

namespace facezip::learn {

struct LearnedTextures {
  std::vector<TextureModel> models;     ///< of the library's maps
  std::vector<LearnedTexture> quality;  ///< likewise
};

/// Reads every texture once.
/// layout  topology and UVs of the subjects
/// meshes  their neutrals and displacements
/// side    texels of the layout along each axis
/// Throws InputError: an image, channels that differ between subjects; Cancelled.
LearnedTextures learnTextures(const Library& library, const geometry::TriangleMesh& layout,
                              const geometry::ShapeLibrary& meshes, int side, Progress& progress);

/// The neutral's textures by the names of `maps`, resampled to the layout.
/// Throws InputError where a map's channels are not as many as `channels` says (0: any).
std::vector<image::FloatImage> readNeutralTextures(const Capture& capture, const std::vector<std::string>& maps,
                                                   const std::vector<int>& channels, int side);

}  // namespace facezip::learn
