#include <benchmark/benchmark.h>

#include "compress/bands/difference.hpp"
#include "compress/search/gram.hpp"
#include "roof.hpp"
#include "synthetic_capture.hpp"

namespace facezip::bench {
namespace {

/// Multiply-adds that the sums need: a product per channel and a weighted sum per slot, for the upper triangle only.
double gramFlops(const compress::DeviceTiles& tiles, const compress::BandShape& shape) {
  double per_pair = 0.0;
  for (std::size_t t = 0; t < tiles.tileCount(); ++t) {
    const auto masks = static_cast<double>(tiles.masksOf(t).size());
    per_pair += compress::kTileTexels * (shape.channels + 1.0 + masks + masks * (masks - 1.0) / 2.0);
  }
  return 2.0 * per_pair * shape.expressions * (shape.expressions + 1.0) / 2.0;
}

/// Arguments: R, N, K. Everything GramAccumulator::add does: plan, kernels, reduction, sums in double.
void runGram(benchmark::State& state, device::KernelVariant variant) {
  device::DeviceContext& context = benchDevice();
  const int resolution = static_cast<int>(state.range(0));
  const compress::BandShape shape{resolution, resolution, 3, static_cast<int>(state.range(1)),
                                  image::SampleType::kUint8};
  const int mask_count = static_cast<int>(state.range(2));
  const compress::TileMasks masks = makeBumpMasks(resolution, mask_count);
  compress::DeviceTiles tiles(context);
  tiles.upload(masks);
  const cl::Buffer samples = context.upload(makeSamples(shape), "samples");
  const cl::Buffer differences =
      context.allocate(compress::differenceBufferBytes(shape, tiles.tileCount()), CL_MEM_READ_WRITE, "differences");
  compress::computeDifferences(context, tiles, shape, samples, differences);
  const compress::GramSlots slots = slotsOf(masks, mask_count);
  compress::GramAccumulator accumulator(context, slots, shape.expressions, variant);
  measure(state, [&] { accumulator.add(tiles, differences, shape, 1.0); });
  setFlopCounters(state, gramFlops(tiles, shape));
  state.counters["slots"] = slots.count();
  state.counters["masks_a_tile"] =
      static_cast<double>(masks.mask_index.size()) / static_cast<double>(masks.tiles.size());
}

void gram(benchmark::State& state) { runGram(state, device::KernelVariant::kCpu); }
void gramGpu(benchmark::State& state) { runGram(state, device::KernelVariant::kGpu); }
BENCHMARK(gram)
    ->ArgNames({"R", "N", "K"})
    ->Args({256, 20, 53})
    ->Args({1024, 8, 53})
    ->Args({1024, 20, 53})
    ->Args({1024, 52, 53})
    ->Args({512, 100, 53})
    ->Args({1024, 20, 16})
    ->Args({1024, 20, 128})
    ->Args({2048, 20, 53})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(gramGpu)
    ->Name("gram_gpu")
    ->ArgNames({"R", "N", "K"})
    ->Args({256, 20, 53})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace facezip::bench
