#include "problems/kmeans.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

/// Arguments: N, K, restarts. Four clusters.
test::KmeansProblem kmeansProblem(const benchmark::State& state) {
  return {benchDevice(),
          test::randomCapture(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), /* seed= */ 1),
          {.clusters = 4, .restarts = static_cast<int>(state.range(2))}};
}

void kmeans(benchmark::State& state) { benchStep(state, kmeansProblem(state)); }

/// All of clusterFragments(): centring, copies, kernel and the choice of the best runs.
void clusterFragments(benchmark::State& state) {
  const test::KmeansProblem problem = kmeansProblem(state);
  measure(state, [&] {
    const auto clustering = compress::clusterFragments(problem.context, problem.grams, problem.options);
    benchmark::DoNotOptimize(clustering.labels.data());
  });
}

void sizes(benchmark::internal::Benchmark* row) {
  row->ArgNames({"N", "K", "restarts"})
      ->Args({8, 16, 64})
      ->Args({20, 53, 64})
      ->Args({20, 53, 256})
      ->Args({52, 53, 64})
      ->Args({100, 128, 64})
      ->Args({128, 200, 64})
      ->Apply(milliseconds);
}
BENCHMARK(kmeans)->Apply(sizes);
BENCHMARK(clusterFragments)->Name("cluster_fragments")->Apply(sizes);

}  // namespace
}  // namespace facezip::bench
