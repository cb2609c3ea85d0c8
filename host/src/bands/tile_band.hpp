// tile_band.hpp - one band of rows of one map, cut into tiles (raster/tiles.hpp).
#pragma once

#include <cstddef>

#include "image/image_file.hpp"
#include "io/counts.hpp"
#include "raster/tiles.hpp"

namespace facezip::compress {

using raster::kTileSide;
using raster::kTileTexels;
using raster::TileMasks;
using raster::TilePosition;
using raster::tilesAlong;

/// Size and type of the samples of a band. A band holds `rows` rows of the image; tiles that hang over the right edge
/// or the last row of the image are padded with texels of no weight.
struct BandShape {
  int width = 0;        ///< texels in a row
  int rows = 0;         ///< rows of the band; a multiple of 16 except in the last band
  int channels = 0;     ///< 1 to 4
  int expressions = 0;  ///< N, without the neutral
  image::SampleType sample_type = image::SampleType::kUint8;
  bool neutral_decoded = false;  ///< differences are to what a coded neutral decodes to, which lies between samples

  /// Bytes of the raw samples: neutral first, then the expressions, each `rows` rows.
  std::size_t sampleBytes() const {
    return toSize(expressions + 1, rows, width, channels) * image::sampleBytes(sample_type);
  }
  int tileColumns() const { return tilesAlong(width); }
  int tileRows() const { return tilesAlong(rows); }
  /// Differences between 8-bit samples are exact in 16-bit integers; all others are floats. Both in units of 1/255.
  std::size_t differenceBytes() const { return sample_type == image::SampleType::kUint8 && !neutral_decoded ? 2 : 4; }
  /// Bytes of a decoded neutral.
  std::size_t neutralBytes() const { return toSize(rows, width, channels) * sizeof(float); }
};

}  // namespace facezip::compress
