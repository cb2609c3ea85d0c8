#include <benchmark/benchmark.h>

#include "compress/bands/difference.hpp"
#include "compress/compress_stretch.hpp"
#include "raster/texel_masks.hpp"
#include "roof.hpp"
#include "synthetic_capture.hpp"

namespace facezip::bench {
namespace {

constexpr int kScale = 8;

/// Arguments: R, N. Must move: differences in, two textures out. Operations: a bilinear weight for each expression and
/// map, a product for each of its channels.
void compressStretch(benchmark::State& state) {
  device::DeviceContext& context = benchDevice();
  const auto resolution = static_cast<int>(state.range(0));
  const compress::BandShape shape{resolution, resolution, 3, static_cast<int>(state.range(1)),
                                  image::SampleType::kUint8};
  compress::TileMasks masks = makeBumpMasks(resolution, 1);
  compress::DeviceTiles tiles(context);
  tiles.upload(masks);
  const cl::Buffer samples = context.upload(makeSamples(shape), "samples");
  const std::size_t bytes = compress::differenceBufferBytes(shape, tiles.tileCount());
  const cl::Buffer differences = context.allocate(bytes, CL_MEM_READ_WRITE, "differences");
  compress::computeDifferences(context, tiles, shape, samples, differences);
  const compress::WeightSpace space{resolution / kScale, resolution / kScale, compress::kCompressStretchMaps,
                                    shape.expressions};
  compress::WeightWindow window(context, space);
  const std::vector<float> weights(static_cast<std::size_t>(space.rows) * space.rowFloats(), 0.05f);
  window.set({0, space.rows, 0, space.rows}, weights, weights);
  const double texels = static_cast<double>(tiles.tileCount()) * compress::kTileTexels;
  const double texture_bytes = texels * 2 * shape.channels * sizeof(float);
  const cl::Buffer textures =
      context.allocate(static_cast<std::size_t>(texture_bytes), CL_MEM_READ_WRITE, "compress and stretch maps");
  context.finish();
  const bool gpu = context.resolve(device::KernelVariant::kAuto) == device::KernelVariant::kGpu;
  measure(state, [&] {
    compress::launchCompressStretch(context, {tiles, shape, differences, 0, kScale}, window, gpu, textures);
    context.finish();
  });
  setBandwidthCounters(state, static_cast<double>(bytes) + texture_bytes);
  setFlopCounters(state, texels * shape.expressions * 2 * (9 + 2 * shape.channels));
}

BENCHMARK(compressStretch)
    ->Name("compress_stretch")
    ->ArgNames({"R", "N"})
    ->Args({1024, 20})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace facezip::bench
