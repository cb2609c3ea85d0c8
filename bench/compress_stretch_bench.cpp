#include "grid_rows.hpp"
#include "problems/compress_stretch.hpp"

namespace facezip::bench {
namespace {

/// Arguments: R, N.
void compressStretch(benchmark::State& state) {
  const test::GridSizes sizes =
      test::squareSizes(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), /* textures= */ 2);
  benchStep(state, test::CompressStretchProblem(benchDevice(), sizes, test::wholeBand(sizes.shape)));
}
BENCHMARK(compressStretch)->Name("compress_stretch")->ArgNames({"R", "N"})->Args({1024, 20})->Apply(milliseconds);

}  // namespace
}  // namespace facezip::bench
