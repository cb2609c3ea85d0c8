#include <benchmark/benchmark.h>

#include "compress/search/seam_cost.hpp"
#include "roof.hpp"
#include "synthetic_grams.hpp"

namespace facezip::bench {
namespace {

/// Arguments: N, K, masks that a mask overlaps on one side. All of computeSeamTables(): centring in double, copies,
/// kernel. An entry multiplies the rows of the members of two clusters, 2 N / C of them, by N values.
void seamCost(benchmark::State& state) {
  device::DeviceContext& context = benchDevice();
  const auto grams =
      makeGrams(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), static_cast<int>(state.range(2)));
  const compress::Clustering clustering = compress::clusterFragments(context, grams, {.restarts = 1});
  measure(state,
          [&] { benchmark::DoNotOptimize(compress::computeSeamTables(context, grams, clustering).values.data()); });
  const double n = grams.expressions, pairs = static_cast<double>(grams.slots.pairs.size());
  setFlopCounters(state, pairs * clustering.clusters * clustering.clusters * 2.0 * (2.0 * n / clustering.clusters) * n);
  state.counters["pairs"] = pairs;
}
BENCHMARK(seamCost)
    ->Name("seam_cost")
    ->ArgNames({"N", "K", "reach"})
    ->Args({8, 16, 9})
    ->Args({20, 53, 9})
    ->Args({52, 53, 9})
    ->Args({100, 128, 9})
    ->Args({128, 200, 10})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace facezip::bench
