#include "problems/weight_blend.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

using device::KernelVariant;

/// Arguments: side of the grid, N. Four textures, no weight 0.
void weightBlend(benchmark::State& state, KernelVariant variant) {
  const auto side = static_cast<int>(state.range(0));
  test::WeightBlendProblem problem(benchDevice(), {side, side, 4, static_cast<int>(state.range(1))}, variant);
  for (float& beta : problem.beta) beta += beta == 0.0f ? 0.5f : 0.0f;
  benchStep(state, problem);
}

void grids(benchmark::internal::Benchmark* row) { row->ArgNames({"cells", "N"})->Apply(milliseconds); }
BENCHMARK_CAPTURE(weightBlend, cpu, KernelVariant::kCpu)
    ->Name("weight_blend")
    ->Apply(grids)
    ->Args({32, 20})
    ->Args({128, 8})
    ->Args({128, 20})
    ->Args({256, 52})
    ->Args({256, 100})
    ->Args({512, 20});
BENCHMARK_CAPTURE(weightBlend, gpu, KernelVariant::kGpu)->Name("weight_blend_gpu")->Apply(grids)->Args({128, 20});

}  // namespace
}  // namespace facezip::bench
