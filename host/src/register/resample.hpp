// resample.hpp - a texture sampled at places of its plane, on the device (kernels/cl/resample.cl).
#pragma once

#include <span>

#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "image/image_file.hpp"

namespace facezip::registration {

/// What launchResample() works on.
struct ResampleLaunch {
  image::SampleType type = image::SampleType::kUint8;
  int channels = 3;  ///< 1 to 4
  int width = 0;
  int height = 0;
  cl_ulong count = 0;  ///< places
  cl::Buffer source;   ///< [height][width][channels]
  cl::Buffer places;   ///< [count][2] float
  cl::Buffer samples;  ///< [count][channels] float
};
/// Throws DeviceError where a buffer is too small.
cl::Event launchResample(device::DeviceContext& context, const ResampleLaunch& launch);

/// A texture on the device.
class TextureSampler {
 public:
  /// Throws DeviceError where the texture is larger than the device's largest allocation.
  TextureSampler(device::DeviceContext& context, const image::Image& texture);

  /// places   x, y of each in texels, centres at integers; NaN: leaves its samples as they are
  /// samples  as many times channels, in units of the texture's samples
  void sample(std::span<const float> places, std::span<float> samples);

  const image::ImageShape& shape() const { return shape_; }

 private:
  device::DeviceContext& context_;
  image::ImageShape shape_;
  cl::Buffer source_;
  device::PooledBuffer places_;
  device::PooledBuffer samples_;
};

}  // namespace facezip::registration
