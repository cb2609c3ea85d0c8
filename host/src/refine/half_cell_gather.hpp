// half_cell_gather.hpp - the equations of the cells of a window from those of their half cells (half_cells.hpp).
#pragma once

#include "device/device_context.hpp"
#include "refine/half_cell_gram.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// Sizes and device buffers of one launch of kernels/cl/half_cell_gather.cl, which describes them.
struct HalfCellGatherLaunch {
  const WeightWindow& window;
  HalfCellRows rows;
  const cl::Buffer& halves;  ///< as launchHalfCellFit() leaves them
  const cl::Buffer& system;  ///< [held rows][columns][systemEntries()] float
};

/// Enqueues the kernel.
cl::Event launchHalfCellGather(device::DeviceContext& context, const HalfCellGatherLaunch& launch);

}  // namespace facezip::compress
