// tile_weights.hpp - how strongly the texels of a tile are weighted: what clamping a texture there would do to frames.
#pragma once

#include <span>
#include <vector>

#include "raster/tiles.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// The largest weight, of either sign and of any expression, that texels of a tile may be given: [tile][C].
/// tiles    of 16 x 16 texels, y counted from texel row `first_row`
/// scale    texels to a cell
/// weights  of `rows`, [row][column][C][lanes]; cells beyond them do not count
std::vector<float> largestWeights(std::span<const raster::TilePosition> tiles, int first_row, int scale,
                                  const WeightSpace& space, const raster::CellRows& rows,
                                  std::span<const float> weights);

}  // namespace facezip::compress
