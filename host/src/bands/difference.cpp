#include "bands/difference.hpp"

#include <fmt/format.h>

#include <cassert>

#include "device/pooled_buffer.hpp"
#include "io/counts.hpp"

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

cl::Event launchDifference(device::DeviceContext& context, const DeviceTiles& tiles, const BandShape& shape,
                           const cl::Buffer& samples, const cl::Buffer& neutral, const cl::Buffer& differences) {
  assert(shape.expressions >= 1);
  if (tiles.tileCount() == 0) return {};
  device::requireBytes(context, samples, shape.sampleBytes(), "samples of a band");
  device::requireBytes(context, differences, differenceBufferBytes(shape, tiles.tileCount()), "differences of a band");
  const cl::Kernel kernel = context.kernel(
      "difference.cl", "difference",
      fmt::format("{} {}{}{}", differenceDefines(shape), sampleDefines(shape.sample_type),
                  shape.neutral_decoded ? " -D NEUTRAL_DECODED" : "", tiles.hasFades() ? " -D FADED" : ""));
  const device::WorkItems items = device::WorkItems(kTileSide, tiles.tileCount(), shape.expressions)
                                      .inGroupsOf(context.workGroupSize(kernel, kTileSide), 1, 1);
  if (tiles.hasFades()) {
    return context.launch(kernel, items, tiles.positions(), samples, neutral, tiles.fades(), differences, shape.width,
                          shape.rows);
  }
  return context.launch(kernel, items, tiles.positions(), samples, neutral, differences, shape.width, shape.rows);
}

}  // namespace

std::size_t differenceBufferBytes(const BandShape& shape, std::size_t tile_count) {
  return toSize(tile_count, shape.expressions, shape.channels, kTileTexels) * shape.differenceBytes();
}

std::string differenceDefines(const BandShape& shape) {
  assert(shape.channels >= 1 && shape.channels <= 4);
  return fmt::format("-D CHANNELS={} -D DIFF_T={}", shape.channels, shape.differenceBytes() == 2 ? "short" : "float");
}

cl::Event computeDifferences(device::DeviceContext& context, const DeviceTiles& tiles, const BandShape& shape,
                             const cl::Buffer& samples, const cl::Buffer& differences) {
  assert(!shape.neutral_decoded);
  return launchDifference(context, tiles, shape, samples, samples, differences);
}

cl::Event computeDifferences(device::DeviceContext& context, const DeviceTiles& tiles, const BandShape& shape,
                             const cl::Buffer& samples, const cl::Buffer& neutral, const cl::Buffer& differences) {
  assert(shape.neutral_decoded);
  if (tiles.tileCount() > 0) device::requireBytes(context, neutral, shape.neutralBytes(), "decoded neutral of a band");
  return launchDifference(context, tiles, shape, samples, neutral, differences);
}

}  // namespace facezip::compress
