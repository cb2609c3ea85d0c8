// shown_texels.hpp - which texels of a package's map change, found in the package itself: it has no region.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "raster/texel_classes.hpp"
#include "refine/grid_weights.hpp"

namespace facezip::convert {

struct ShownTexels {
  /// Active: texels of tiles in which a difference texture holds something. Covered: those of them that the mesh shows,
  /// of a package without a mesh all.
  std::shared_ptr<const raster::TexelClasses> classes;
  std::vector<std::uint8_t> cells;  ///< of the weight grid: 1 if the cell has a covered texel
  double energy = 0.0;              ///< of the differences of all expressions, about, in (1/255)^2
};

/// Reads the difference textures of a map.
/// mesh     with UVs; none: every texel is shown
/// weights  of the map, on the grid of `space`
/// Throws InputError, Cancelled.
ShownTexels findShownTexels(const Package& package, int map_index, const std::optional<geometry::TriangleMesh>& mesh,
                            const compress::EncodedWeights& weights, const compress::WeightSpace& space,
                            Progress& progress);

/// UVs and triangles of the package's mesh, without positions; none where it has no mesh or that no UVs.
/// Throws InputError: a damaged mesh, one that needs more memory.
std::optional<geometry::TriangleMesh> uvMesh(const Package& package, std::uint64_t memory_bytes);

}  // namespace facezip::convert
