// tiles.hpp - texels in tiles of 16 x 16, and the masks of each: the unit of work of every texel-sized kernel.
// kernels/cl/tiles.h describes the same layout for the device.
#pragma once

#include <vector>

#include "cl/layout.h"
#include "io/counts.hpp"

namespace facezip::raster {

inline constexpr int kTileSide = FACEZIP_TILE_SIDE;
inline constexpr int kTileTexels = FACEZIP_TILE_TEXELS;

/// Tiles that cover `texels` along one axis; the last one may hang over.
constexpr int tilesAlong(int texels) { return divideUp(texels, kTileSide); }

/// Position of a tile: column of tiles in the image, row of tiles in the band.
struct TilePosition {
  int x = 0;
  int y = 0;
};

/// The tiles of a band that hold anything to do, and the masks that are active in each (host memory).
/// Masks of tile t are entries mask_begin[t] .. mask_begin[t + 1] of mask_index and mask_weights.
struct TileMasks {
  std::vector<TilePosition> tiles;   ///< #tiles, in rising (y, x)
  std::vector<int> mask_begin;       ///< #tiles + 1
  std::vector<int> mask_index;       ///< rising inside a tile; values in [0, K)
  std::vector<float> mask_weights;   ///< mask_index.size() x 256, M_k(p) in [0, 1], also in the gutter
  std::vector<float> texel_weights;  ///< #tiles x 256, weight of a texel in every sum; 0 if not covered (gutter too)
  std::vector<float> fades;          ///< #tiles x 256, factor of a texel's differences; empty where all are 1
};

/// Two masks k < l that are both above zero at one texel or more.
struct MaskPair {
  int k = 0;
  int l = 0;
  bool operator==(const MaskPair&) const = default;
};

}  // namespace facezip::raster
