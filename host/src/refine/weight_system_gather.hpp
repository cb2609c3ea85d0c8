// weight_system_gather.hpp - the equations of the cells of a window, added up from the sums of the tiles of a band.
#pragma once

#include "device/device_context.hpp"
#include "refine/grid_band.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// Sizes and device buffers of one launch of kernels/cl/weight_system_gather.cl, which describes them.
struct WeightSystemGatherLaunch {
  const GridBand& band;
  const WeightWindow& window;
  float metric_weight = 1.0f;
  bool keep = false;          ///< adds to what `system` holds
  const cl::Buffer& tile_at;  ///< tileLookup()
  const cl::Buffer& partial;  ///< as weight_system.cl writes it
  const cl::Buffer& system;   ///< [held rows][columns][systemEntries()] float
};

/// Enqueues the kernel.
cl::Event launchWeightSystemGather(device::DeviceContext& context, const WeightSystemGatherLaunch& launch);

}  // namespace facezip::compress
