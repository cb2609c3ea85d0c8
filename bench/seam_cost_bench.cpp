#include "problems/seam_cost.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

/// Arguments: N, K, masks that a mask overlaps on one side.
void seamCost(benchmark::State& state) {
  const auto expressions = static_cast<int>(state.range(0));
  const auto masks = static_cast<int>(state.range(1));
  test::SeamCostProblem problem(benchDevice(),
                                test::wideCapture(expressions, masks, static_cast<int>(state.range(2)), /* seed= */ 1),
                                test::hashedClustering(masks, expressions, 4, 4, /* seed= */ 3));
  benchStep(state, problem);
  state.counters["pairs"] = static_cast<double>(problem.grams.slots.pairs.size());
}
BENCHMARK(seamCost)
    ->Name("seam_cost")
    ->ArgNames({"N", "K", "reach"})
    ->Args({8, 16, 9})
    ->Args({20, 53, 9})
    ->Args({52, 53, 9})
    ->Args({100, 128, 9})
    ->Args({128, 200, 10})
    ->Apply(milliseconds);

}  // namespace
}  // namespace facezip::bench
