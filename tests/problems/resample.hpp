// resample.hpp - problem of the step `resample`: a texture of hashed samples at places in the order of another layout.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "problems/guarded_buffer.hpp"
#include "problems/hashed.hpp"
#include "reference/resample.hpp"
#include "register/resample.hpp"

namespace facezip::test {

struct ResampleSizes {
  int width = 0;
  int height = 0;
  int channels = 3;
  image::SampleType type = image::SampleType::kUint8;
  std::size_t count = 0;
};

/// Must move: the places in, the texture once, the samples out. Operations: 16 multiply-adds for each channel.
struct ResampleProblem {
  /// Every 16th place is none; some lie beyond the edges.
  ResampleProblem(device::DeviceContext& device, const ResampleSizes& problem_sizes)
      : context(device), sizes(problem_sizes), samples(device, sizes.count * toSize(sizes.channels) * sizeof(float)) {
    Hashed hashed(sizes.count);
    std::vector<std::byte> bytes(toSize(sizes.width, sizes.height, sizes.channels) * image::sampleBytes(sizes.type));
    if (sizes.type == image::SampleType::kFloat32) {
      for (std::size_t i = 0; i < bytes.size(); i += sizeof(float)) {
        const float value = hashed.between(0.0f, 1.0f);
        std::memcpy(bytes.data() + i, &value, sizeof(value));
      }
    } else {
      hashed.fill(bytes);
    }
    const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(sizes.count))));
    for (std::size_t i = 0; i < sizes.count; ++i) {
      // Turned by a quarter, as charts are, with a little noise.
      const double u = static_cast<double>(i / side) / static_cast<double>(side);
      const double v = static_cast<double>(i % side) / static_cast<double>(side);
      places.push_back(static_cast<float>(1.04 * u * sizes.width - 0.02 * sizes.width) + hashed.between(-0.7f, 0.7f));
      places.push_back(static_cast<float>(1.04 * v * sizes.height - 0.02 * sizes.height) + hashed.between(-0.7f, 0.7f));
      if (i % 16 == 5) places.back() = std::numeric_limits<float>::quiet_NaN();
    }
    for (std::size_t i = 0; i < bytes.size(); i += image::sampleBytes(sizes.type)) {
      source.push_back(valueAt(bytes.data() + i));
    }
    launch = {sizes.type,
              sizes.channels,
              sizes.width,
              sizes.height,
              sizes.count,
              device.upload(bytes, "texture"),
              device.upload(places, "places"),
              samples.buffer()};
  }

  void run() {
    registration::launchResample(context, launch);
    context.finish();
  }
  std::vector<float> result() const { return samples.read<float>(); }
  bool isPlace(std::size_t i) const { return !std::isnan(places[2 * i + 1]); }
  double expected(std::size_t i, int channel) const {
    return reference::resampled(source, sizes.width, sizes.height, sizes.channels, double{places[2 * i]},
                                double{places[2 * i + 1]}, channel);
  }
  double fullScale() const {
    return sizes.type == image::SampleType::kUint8 ? 255.0 : sizes.type == image::SampleType::kUint16 ? 65535.0 : 1.0;
  }

  double bytes() const {
    return static_cast<double>(sizes.count) * 4.0 * (2 + sizes.channels) +
           static_cast<double>(source.size() * image::sampleBytes(sizes.type));
  }
  double flops() const { return static_cast<double>(sizes.count) * (32.0 * sizes.channels + 40.0); }

  device::DeviceContext& context;
  ResampleSizes sizes;
  std::vector<double> source;
  std::vector<float> places;
  GuardedBuffer samples;
  registration::ResampleLaunch launch;

 private:
  double valueAt(const std::byte* at) const {
    if (sizes.type == image::SampleType::kUint8) return static_cast<double>(*at);
    if (sizes.type == image::SampleType::kUint16) {
      std::uint16_t value = 0;
      std::memcpy(&value, at, sizeof(value));
      return value;
    }
    float value = 0.0f;
    std::memcpy(&value, at, sizeof(value));
    return double{value};
  }
};

}  // namespace facezip::test
