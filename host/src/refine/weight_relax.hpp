// weight_relax.hpp - block Gauss-Seidel sweeps over the free weights of a window, in four colours.
#pragma once

#include "device/device_context.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// Sizes and device buffers of some sweeps of kernels/cl/weight_relax.cl, which describes them.
struct WeightRelaxLaunch {
  const WeightWindow& window;  ///< its weights change
  int sweeps = 1;
  float smoothness = 0.0f;   ///< above 0
  float trust = 0.0f;        ///< above 0
  const cl::Buffer& system;  ///< [held rows][columns][systemEntries()] float
};

/// Enqueues the kernel four times a sweep, one colour after the other.
/// variant  16 expressions to a work-item (kCpu) or one (kGpu)
void launchWeightRelax(device::DeviceContext& context, const WeightRelaxLaunch& launch,
                       device::KernelVariant variant = device::KernelVariant::kAuto);

}  // namespace facezip::compress
