// half_cell_fit.hpp - what the difference textures that suit given weights add to the equations of the weights, from
// the Gram matrices of the half cells (half_cells.hpp).
#pragma once

#include "device/device_context.hpp"
#include "refine/half_cell_gram.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// Numbers of a half cell's equations: its block, rounded up to 16, then the right-hand sides.
std::size_t halfCellEntries(const WeightSpace& space);

/// Sizes and device buffers of one launch of kernels/cl/half_cell_fit.cl, which describes them.
struct HalfCellFitLaunch {
  const WeightWindow& window;  ///< holds the cells that the half cells lie between
  HalfCellRows rows;
  float ridge = 0.0f;  ///< above 0
  const cl::Buffer& grams;
  const cl::Buffer& halves;  ///< [half row][half column][halfCellEntries()] float
  const cl::Buffer& errors;  ///< [half row][group] float
};

/// Enqueues the kernel.
cl::Event launchHalfCellFit(device::DeviceContext& context, const HalfCellFitLaunch& launch);

}  // namespace facezip::compress
