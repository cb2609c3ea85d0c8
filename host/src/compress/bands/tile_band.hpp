// tile_band.hpp - one band of rows of one map, cut into tiles of 16 x 16 texels.
// The unit of work of every texel-sized kernel; kernels/cl/tiles.h describes the same layout for the device.
#pragma once

#include <cstddef>
#include <vector>

#include "cl/layout.h"
#include "image/image_file.hpp"
#include "io/counts.hpp"

namespace facezip::compress {

inline constexpr int kTileSide = FACEZIP_TILE_SIDE;
inline constexpr int kTileTexels = FACEZIP_TILE_TEXELS;

/// Position of a tile: column of tiles in the image, row of tiles in the band.
struct TilePosition {
  int x = 0;
  int y = 0;
};

/// Size and type of the samples of a band. A band holds `rows` rows of the image; tiles that hang over the right edge
/// or the last row of the image are padded with texels of no weight.
struct BandShape {
  int width = 0;        ///< texels in a row
  int rows = 0;         ///< rows of the band; a multiple of 16 except in the last band
  int channels = 0;     ///< 1 to 4
  int expressions = 0;  ///< N, without the neutral
  image::SampleType sample_type = image::SampleType::kUint8;

  /// Bytes of the raw samples: neutral first, then the expressions, each `rows` rows.
  std::size_t sampleBytes() const {
    return toSize(expressions + 1, rows, width, channels) * image::sampleBytes(sample_type);
  }
  int tileColumns() const { return divideUp(width, kTileSide); }
  int tileRows() const { return divideUp(rows, kTileSide); }
  /// Differences of 8-bit samples are exact in 16-bit integers; all others are floats. Both in units of 1/255.
  std::size_t differenceBytes() const { return sample_type == image::SampleType::kUint8 ? 2 : 4; }
};

/// The tiles of a band that hold anything to do, and the masks that are active in each (host memory).
/// Masks of tile t are entries mask_begin[t] .. mask_begin[t + 1] of mask_index and mask_weights.
struct TileMasks {
  std::vector<TilePosition> tiles;  ///< #tiles, in rising (y, x)
  std::vector<int> mask_begin;      ///< #tiles + 1
  std::vector<int> mask_index;      ///< rising inside a tile; values in [0, K)
  std::vector<float> mask_weights;  ///< mask_index.size() x 256, M_k(p) in [0, 1], also in the gutter
  std::vector<float>
      texel_weights;  ///< #tiles x 256, weight of a texel in every sum: 0 outside the covered texels (gutter too)
};

}  // namespace facezip::compress
