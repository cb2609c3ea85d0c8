// difference_target.hpp - what a difference texture should be when those behind it are coded already.
#pragma once

#include "device/device_context.hpp"
#include "refine/difference_fit.hpp"

namespace facezip::compress {

/// Device buffers of the coded fit of one band; kernels/cl/difference_target.cl describes them.
struct CodedBuffers {
  std::size_t tile_count = 0;
  int channels = 0;
  const cl::Buffer& factors;   ///< DifferenceFit::computeFactors()
  const cl::Buffer& encoding;  ///< [C][channel] float2: scale, zero code
  const cl::Buffer& codes;     ///< [tile][C][channel][256] float, code units
};

/// Writes the target of texture `texture`, in code units, into its planes of the codes. Does not wait.
/// variant  16 texels to a work-item (kCpu) or one (kGpu)
cl::Event launchDifferenceTarget(device::DeviceContext& context, const WeightSpace& space, const CodedBuffers& buffers,
                                 int texture, device::KernelVariant variant = device::KernelVariant::kAuto);

}  // namespace facezip::compress
