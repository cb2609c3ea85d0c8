// difference_settle.hpp - difference textures from their codes, and the error that they leave.
#pragma once

#include "refine/difference_target.hpp"

namespace facezip::compress {

/// Where the outcome goes; kernels/cl/difference_settle.cl describes it.
struct SettledBuffers {
  const cl::Buffer& texel_weights;  ///< [tile][256] float
  const cl::Buffer& textures;       ///< [tile][C][channel][256] float, units of 1/255
  const cl::Buffer& errors;         ///< [tile][settledErrors()] float2: weighted, plain
};

/// Sums of errors that a tile gets.
int settledErrors(const device::DeviceContext& context, device::KernelVariant variant);

/// Does not wait.
cl::Event launchDifferenceSettle(device::DeviceContext& context, const WeightSpace& space, const CodedBuffers& buffers,
                                 const SettledBuffers& settled, float ridge,
                                 device::KernelVariant variant = device::KernelVariant::kAuto);

}  // namespace facezip::compress
