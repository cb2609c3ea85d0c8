// half_cell_gram.hpp - Gram matrices of the differences over the quarters of every cell (half_cells.hpp says why).
#pragma once

#include "device/device_context.hpp"
#include "refine/grid_band.hpp"

namespace facezip::compress {

/// Some rows of the half cells of a grid, in groups of 16 side by side: what a work-item takes.
struct HalfCellRows {
  int first = 0;   ///< of the grid
  int count = 0;   ///< half rows
  int groups = 0;  ///< of a row; the last one is padded

  /// Half cells in a row of the buffers.
  int columns() const { return FACEZIP_VECTOR * groups; }
};

/// Bytes of the Gram matrices, [half row][group][m (m + 1) / 2 + n][16] float.
std::size_t halfCellGramBytes(const HalfCellRows& rows, int expressions);

/// Sizes and device buffers of one launch of kernels/cl/half_cell_gram.cl, which describes them.
struct HalfCellGramLaunch {
  const GridBand& band;  ///< its weight scale is 4, 8, 16 or 32
  HalfCellRows rows;
  float metric_weight = 1.0f;
  bool keep = false;  ///< adds to what `grams` holds
  const cl::Buffer& tile_at;
  const cl::Buffer& grams;
};

/// Enqueues the kernel. Throws DeviceError if the band's differences are too few.
cl::Event launchHalfCellGram(device::DeviceContext& context, const HalfCellGramLaunch& launch);

}  // namespace facezip::compress
