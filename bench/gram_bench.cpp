#include "problems/gram.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

/// Arguments: R, N, K.
void gram(benchmark::State& state, device::KernelVariant variant) {
  const auto side = static_cast<int>(state.range(0));
  const auto mask_count = static_cast<int>(state.range(2));
  const test::BandShape shape{side, side, 3, static_cast<int>(state.range(1)), image::SampleType::kUint8};
  test::GramProblem problem(benchDevice(), shape, test::bumpMasks(side, mask_count), mask_count, variant);
  benchStep(state, problem);
  state.counters["slots"] = problem.slots.count();
  state.counters["masks_a_tile"] =
      static_cast<double>(problem.masks.mask_index.size()) / static_cast<double>(problem.tileCount());
}
BENCHMARK_CAPTURE(gram, cpu, device::KernelVariant::kCpu)
    ->Name("gram")
    ->ArgNames({"R", "N", "K"})
    ->Args({256, 20, 53})
    ->Args({1024, 8, 53})
    ->Args({1024, 20, 53})
    ->Args({1024, 52, 53})
    ->Args({512, 100, 53})
    ->Args({1024, 20, 16})
    ->Args({1024, 20, 128})
    ->Args({2048, 20, 53})
    ->Apply(milliseconds);
BENCHMARK_CAPTURE(gram, gpu, device::KernelVariant::kGpu)
    ->Name("gram_gpu")
    ->ArgNames({"R", "N", "K"})
    ->Args({256, 20, 53})
    ->Apply(milliseconds);

}  // namespace
}  // namespace facezip::bench
