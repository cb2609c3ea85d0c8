#include <benchmark/benchmark.h>

#include "compress/search/kmeans.hpp"
#include "roof.hpp"
#include "synthetic_grams.hpp"

namespace facezip::bench {
namespace {

compress::KmeansOptions optionsOf(const benchmark::State& state) {
  return {.clusters = 4, .restarts = static_cast<int>(state.range(2))};
}

/// Operations of all runs: an iteration adds N rows of N, and compares N fragments with C centres by a multiply-add.
double kmeansFlops(const compress::KmeansRuns& runs, int clusters) {
  const double n = runs.expressions;
  double iterations = 0.0;
  for (const auto count : runs.iterations) iterations += count;
  return iterations * (n * n + 2.0 * n * clusters);
}

/// Arguments: N, K, restarts. The kernel alone.
void kmeans(benchmark::State& state) {
  device::DeviceContext& context = benchDevice();
  const auto grams = makeGrams(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), 0);
  const auto options = optionsOf(state);
  const auto runs = compress::runKmeans(context, grams, options);
  const compress::KmeansLaunch launch{
      .masks = runs.masks,
      .expressions = runs.expressions,
      .options = options,
      .gram = context.upload(compress::packKmeansGrams(grams), "gram"),
      .labels = context.allocate(runs.labels.size(), CL_MEM_WRITE_ONLY, "labels"),
      .iterations = context.allocate(runs.iterations.size() * sizeof(cl_int), CL_MEM_WRITE_ONLY, "iterations")};
  measure(state, [&] {
    compress::launchKmeans(context, launch);
    context.finish();
  });
  setFlopCounters(state, kmeansFlops(runs, options.clusters));
}

/// Arguments: N, K, restarts. All of clusterFragments(): centring, copies, kernel and the choice of the best runs.
void clusterFragments(benchmark::State& state) {
  device::DeviceContext& context = benchDevice();
  const auto grams = makeGrams(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), 0);
  measure(state, [&] {
    benchmark::DoNotOptimize(compress::clusterFragments(context, grams, optionsOf(state)).labels.data());
  });
}

void sizes(benchmark::internal::Benchmark* row) {
  row->ArgNames({"N", "K", "restarts"})
      ->Args({8, 16, 64})
      ->Args({20, 53, 64})
      ->Args({20, 53, 256})
      ->Args({52, 53, 64})
      ->Args({100, 128, 64})
      ->Args({128, 200, 64});
  row->UseManualTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK(kmeans)->Apply(sizes);
BENCHMARK(clusterFragments)->Name("cluster_fragments")->Apply(sizes);

}  // namespace
}  // namespace facezip::bench
