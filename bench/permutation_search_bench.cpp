// permutation_search_bench.cpp - steps on the host: 100 restarts of coordinate descent, and the solver with its bound.
#include "problems/seam_cost.hpp"
#include "roof.hpp"
#include "search/permutation_search.hpp"
#include "search/permutation_solver.hpp"

namespace facezip::bench {
namespace {

/// Arguments: K, C. Tables of 20 expressions under masks that overlap nine others on either side.
compress::SeamTables tablesOf(const benchmark::State& state) {
  const auto masks = static_cast<int>(state.range(0));
  const auto clusters = static_cast<int>(state.range(1));
  test::SeamCostProblem problem(benchDevice(), test::wideCapture(20, masks, /* reach= */ 9, /* seed= */ 1), {});
  problem.clustering = compress::clusterFragments(benchDevice(), problem.grams, {.clusters = clusters, .restarts = 1});
  problem.run();
  return problem.result();
}

void permutationSearch(benchmark::State& state) {
  const compress::SeamTables tables = tablesOf(state);
  measure(state, [&] { benchmark::DoNotOptimize(compress::searchPermutation(tables).best.cost); });
}

void permutationSolver(benchmark::State& state) {
  const compress::SeamTables tables = tablesOf(state);
  measure(state, [&] { benchmark::DoNotOptimize(compress::solvePermutation(tables).best.cost); });
}

void sizes(benchmark::internal::Benchmark* row) {
  row->ArgNames({"K", "C"})->Args({16, 4})->Args({53, 4})->Args({53, 8})->Args({128, 4})->Args({200, 4});
  row->Apply(milliseconds);
}
BENCHMARK(permutationSearch)->Name("permutation_search")->Apply(sizes);
BENCHMARK(permutationSolver)->Name("permutation_solver")->ArgNames({"K", "C"})->Args({53, 4})->Apply(milliseconds);

}  // namespace
}  // namespace facezip::bench
