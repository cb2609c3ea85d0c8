#include <benchmark/benchmark.h>

#include "compress/bands/difference.hpp"
#include "roof.hpp"
#include "synthetic_capture.hpp"

namespace facezip::bench {
namespace {

/// Arguments: R, N. Must move: the samples once in, the differences once out.
void difference(benchmark::State& state) {
  device::DeviceContext& context = benchDevice();
  const int resolution = static_cast<int>(state.range(0));
  const compress::BandShape shape{resolution, resolution, 3, static_cast<int>(state.range(1)),
                                  image::SampleType::kUint8};
  compress::DeviceTiles tiles(context);
  tiles.upload(makeBumpMasks(resolution, 1));
  const cl::Buffer samples = context.upload(makeSamples(shape), "samples");
  const std::size_t bytes = compress::differenceBufferBytes(shape, tiles.tileCount());
  const cl::Buffer differences = context.allocate(bytes, CL_MEM_READ_WRITE, "differences");
  measure(state, [&] {
    compress::computeDifferences(context, tiles, shape, samples, differences);
    context.finish();
  });
  setBandwidthCounters(state, static_cast<double>(shape.sampleBytes() + bytes));
}
BENCHMARK(difference)
    ->ArgNames({"R", "N"})
    ->Args({256, 20})
    ->Args({1024, 8})
    ->Args({1024, 20})
    ->Args({1024, 100})
    ->Args({2048, 20})
    ->Args({4096, 8})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace facezip::bench
