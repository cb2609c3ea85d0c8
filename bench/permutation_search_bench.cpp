#include <benchmark/benchmark.h>

#include "compress/search/permutation_search.hpp"
#include "roof.hpp"
#include "synthetic_grams.hpp"

namespace facezip::bench {
namespace {

/// Arguments: K, C. 100 restarts of the search on the host, on the tables of 20 random expressions.
void permutationSearch(benchmark::State& state) {
  device::DeviceContext& context = benchDevice();
  const auto grams = makeGrams(20, static_cast<int>(state.range(0)), 9);
  const auto clustering =
      compress::clusterFragments(context, grams, {.clusters = static_cast<int>(state.range(1)), .restarts = 1});
  const compress::SeamTables tables = compress::computeSeamTables(context, grams, clustering);
  measure(state, [&] { benchmark::DoNotOptimize(compress::searchPermutation(tables).best.cost); });
}
BENCHMARK(permutationSearch)
    ->Name("permutation_search")
    ->ArgNames({"K", "C"})
    ->Args({16, 4})
    ->Args({53, 4})
    ->Args({53, 8})
    ->Args({128, 4})
    ->Args({200, 4})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace facezip::bench
