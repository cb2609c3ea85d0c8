#include "compress/bands/difference.hpp"

#include <fmt/format.h>

#include <cassert>

#include "device/pooled_buffer.hpp"

namespace facezip::compress {
namespace {

/// Type and unit of the samples, for difference.cl.
std::string sampleDefines(image::SampleType type) {
  switch (type) {
    case image::SampleType::kUint8:
      return "-D SAMPLE_T=uchar";
    case image::SampleType::kUint16:
      // One rounding as everywhere else: the value that image::unit255() has, to the last bit.
      return fmt::format("-D SAMPLE_T=ushort -D SAMPLE_UNIT={:.9g}f", image::unit255(type));
    case image::SampleType::kFloat32:
      break;
  }
  return fmt::format("-D SAMPLE_T=float -D SAMPLE_UNIT={:.1f}f", image::unit255(type));
}

}  // namespace

std::size_t differenceBufferBytes(const BandShape& shape, std::size_t tile_count) {
  return tile_count * static_cast<std::size_t>(shape.expressions) * static_cast<std::size_t>(shape.channels) *
         kTileTexels * shape.differenceBytes();
}

std::string differenceDefines(const BandShape& shape) {
  assert(shape.channels >= 1 && shape.channels <= 4);
  return fmt::format("-D CHANNELS={} -D DIFF_T={}", shape.channels, shape.differenceBytes() == 2 ? "short" : "float");
}

cl::Event computeDifferences(device::DeviceContext& context, const DeviceTiles& tiles, const BandShape& shape,
                             const cl::Buffer& samples, const cl::Buffer& differences) {
  assert(shape.expressions >= 1);
  if (tiles.tileCount() == 0) return {};
  device::requireBytes(context, samples, shape.sampleBytes(), "samples of a band");
  device::requireBytes(context, differences, differenceBufferBytes(shape, tiles.tileCount()), "differences of a band");
  cl::Kernel kernel =
      context.kernel("difference.cl", "difference", differenceDefines(shape) + " " + sampleDefines(shape.sample_type));
  kernel.setArg(0, tiles.positions());
  kernel.setArg(1, samples);
  kernel.setArg(2, differences);
  kernel.setArg(3, static_cast<cl_int>(shape.width));
  kernel.setArg(4, static_cast<cl_int>(shape.rows));
  const cl::NDRange local(context.workGroupSize(kernel, kTileSide), 1, 1);
  return context.run(kernel, cl::NDRange(kTileSide, tiles.tileCount(), static_cast<std::size_t>(shape.expressions)),
                     local);
}

}  // namespace facezip::compress
