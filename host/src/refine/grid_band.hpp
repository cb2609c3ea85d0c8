// grid_band.hpp - a band of texels above the weight grid, as the kernels of the refinement get it.
#pragma once

#include <string>
#include <vector>

#include "bands/device_tiles.hpp"
#include "bands/tile_band.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// A band of one map on the device, and where it lies on the weight grid. References must outlive what takes it.
struct GridBand {
  const DeviceTiles& tiles;  ///< one mask a tile: above 0 where difference textures are wanted
  const BandShape& shape;
  const cl::Buffer& differences;  ///< what computeDifferences() wrote for the same tiles and shape
  int first_row = 0;              ///< of the band in the image
  int weight_scale = 0;           ///< texels of this map per cell, 1 to 64
};

/// "-D ..." of the kernels that know both texels and the weight grid.
std::string gridDefines(const BandShape& shape, const WeightSpace& space, int weight_scale);

/// [tile row][tile column] of the band: index of the tile, -1 where there is none.
std::vector<int> tileLookup(const TileMasks& tiles, const BandShape& shape);

}  // namespace facezip::compress
