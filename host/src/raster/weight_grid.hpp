// weight_grid.hpp - masks at the cells of the weight map, which is a fraction of the texture's size.
#pragma once

#include <cstdint>
#include <vector>

#include "compress/search/weight_map.hpp"
#include "raster/texel_masks.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::raster {

/// Masks at every cell of the weight grid.
struct WeightGrid {
  int width = 0;                      ///< cells
  int height = 0;                     ///< cells
  compress::CellMasks cells;          ///< width x height of them, row-major; a cell's weights sum to 1
  std::vector<std::uint8_t> covered;  ///< of every cell: 1 if it has a covered texel
};

/// Averages the masks over the covered texels of each cell of scale x scale texels. Cells without covered texels copy
/// the nearest cell that has some, so that no bilinear footprint and no mip level of the weights reaches an empty cell.
/// Memory: one sparse row per cell, 1 / scale^2 of the texels. The raster is read in bands.
WeightGrid makeWeightGrid(const TexelMasks& masks, const UvRaster& raster, int scale);

}  // namespace facezip::raster
