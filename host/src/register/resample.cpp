#include "register/resample.hpp"

#include <fmt/format.h>

#include <cassert>

#include "io/counts.hpp"

namespace facezip::registration {
namespace {

const char* kernelType(image::SampleType type) {
  switch (type) {
    case image::SampleType::kUint8:
      return "uchar";
    case image::SampleType::kUint16:
      return "ushort";
    case image::SampleType::kFloat32:
      break;
  }
  return "float";
}

}  // namespace

cl::Event launchResample(device::DeviceContext& context, const ResampleLaunch& launch) {
  if (launch.count == 0) return {};
  device::requireBytes(context, launch.source,
                       toSize(launch.width, launch.height, launch.channels) * image::sampleBytes(launch.type),
                       "texture to resample");
  device::requireBytes(context, launch.places, toSize(launch.count, 2) * sizeof(float), "places to resample at");
  device::requireBytes(context, launch.samples, toSize(launch.count, launch.channels) * sizeof(float), "samples");
  const cl::Kernel kernel =
      context.kernel("resample.cl", "resample",
                     fmt::format("-D CHANNELS={} -D SAMPLE_T={}", launch.channels, kernelType(launch.type)));
  const std::size_t group = context.workGroupSize(kernel, 64);
  return context.launch(kernel, device::WorkItems(roundUp(launch.count, group)).inGroupsOf(group), launch.source,
                        launch.places, launch.samples, launch.count, launch.width, launch.height);
}

TextureSampler::TextureSampler(device::DeviceContext& context, const image::Image& texture)
    : context_(context),
      shape_(texture.shape),
      source_(context.upload(texture.samples, "texture of a scan")),
      places_(context, "places in a scan's texture", CL_MEM_READ_ONLY),
      samples_(context, "samples of a scan's texture") {}

void TextureSampler::sample(std::span<const float> places, std::span<float> samples) {
  const std::size_t count = places.size() / 2;
  assert(samples.size() == count * toSize(shape_.channels));
  if (count == 0) return;
  const cl::Buffer& in = places_.upload(places);
  const cl::Buffer& out = samples_.upload(samples);
  launchResample(context_, {shape_.type, shape_.channels, shape_.width, shape_.height, count, source_, in, out});
  samples_.read(samples);
}

}  // namespace facezip::registration
