#include "problems/weight_map.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

/// Arguments: side of the weight map, N, K. Up to 14 masks in a cell, seven on average.
void weightMap(benchmark::State& state) {
  benchStep(state, test::WeightMapProblem(benchDevice(), {.cells = toSize(state.range(0), state.range(0)),
                                                          .expressions = static_cast<int>(state.range(1)),
                                                          .masks = static_cast<int>(state.range(2)),
                                                          .clusters = 4,
                                                          .most_masks = 14}));
}
BENCHMARK(weightMap)
    ->Name("weight_map")
    ->ArgNames({"side", "N", "K"})
    ->Args({32, 20, 53})
    ->Args({128, 8, 16})
    ->Args({128, 20, 53})
    ->Args({256, 52, 53})
    ->Args({256, 100, 128})
    ->Args({512, 8, 53})
    ->Apply(milliseconds);

}  // namespace
}  // namespace facezip::bench
