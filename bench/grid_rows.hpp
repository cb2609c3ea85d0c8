// grid_rows.hpp - sizes of the rows of the refinement's steps.
#pragma once

#include "problems/grid.hpp"
#include "roof.hpp"

namespace facezip::bench {

/// Arguments: R, N, C. A window that holds the whole of a square map, every weight free.
inline test::GridSizes gridSizes(const benchmark::State& state) {
  return test::squareSizes(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
                           static_cast<int>(state.range(2)));
}

/// The problem of a row; more: what it takes behind what is free.
template <typename Problem, typename... More>
Problem gridProblem(const benchmark::State& state, const More&... more) {
  const test::GridSizes sizes = gridSizes(state);
  return Problem(benchDevice(), sizes, test::wholeBand(sizes.shape), test::Free::kAllRows, more...);
}

inline void gridArguments(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R", "N", "C"})->Apply(milliseconds);
  row->Args({256, 20, 4})->Args({1024, 8, 4})->Args({1024, 20, 4})->Args({1024, 52, 4});
  row->Args({512, 100, 4})->Args({2048, 8, 4})->Args({1024, 20, 1})->Args({1024, 20, 8});
}
/// Of a variant that is for another kind of device.
inline void smallGridArguments(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R", "N", "C"})->Apply(milliseconds)->Args({128, 20, 4});
}

}  // namespace facezip::bench
