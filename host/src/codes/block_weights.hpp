// block_weights.hpp - what the texels of a band count when they are coded in blocks.
#pragma once

#include <vector>

#include "bands/tile_band.hpp"
#include "raster/texel_classes.hpp"

namespace facezip::compress {

/// Gutter texels show through bilinear filters and in mip levels alone. In a block beside the face they shall not spoil
/// the covered ones.
inline constexpr float kGutterWeight = 0.125f;
/// A neutral's texels that nothing shows: they are kept in sight, where that costs nothing.
inline constexpr float kUnseenWeight = 1.0f / 64.0f;

/// [tile][256]: the texel weight of covered texels, kGutterWeight in the gutter, 0 where no difference is wanted.
/// masks  raster::activeTiles(), weighed or not
std::vector<float> blockWeights(const TileMasks& masks);

/// Of a neutral's rows [begin, end), in rows: 1 where covered, else kGutterWeight or kUnseenWeight.
std::vector<float> neutralBlockWeights(const raster::TexelClasses& classes, int begin, int end);

/// Rows [begin, end), in rows: 1 where covered, 0 elsewhere. What mip levels are means over.
std::vector<float> coverageRows(const raster::TexelClasses& classes, int begin, int end);

}  // namespace facezip::compress
