// grid_masks.hpp - masks at the cells of the weight grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "raster/texel_masks.hpp"
#include "raster/uv_raster.hpp"
#include "raster/weight_grid.hpp"

namespace facezip::raster {

/// Masks at the cells of the weight grid, a row of cells after the other. Entries of cell p are
/// cell_begin[p] .. cell_begin[p + 1] of the other two.
struct CellMasks {
  std::vector<int> cell_begin;      ///< #cells + 1, rising from 0
  std::vector<int> mask_index;      ///< in [0, K), no mask twice in a cell
  std::vector<float> mask_weights;  ///< M_k at the cell, in [0, 1]; a cell's sum to 1; no entry means weights of 0

  std::size_t cells() const { return cell_begin.empty() ? 0 : cell_begin.size() - 1; }
};

/// The grid with the masks at every cell.
struct GridMasks : WeightGrid {
  CellMasks cells;
  std::vector<std::uint8_t> covered;  ///< of every cell: 1 if it has a covered texel
};

/// Averages the masks over the covered texels of each cell of scale x scale texels. Cells without covered texels copy
/// the nearest cell that has some, so that no bilinear footprint and no mip level of the weights reaches an empty cell.
/// Memory: one sparse row per cell, 1 / scale^2 of the texels. The raster is read in bands.
GridMasks makeGridMasks(const TexelMasks& masks, const UvRaster& raster, int scale);

}  // namespace facezip::raster
