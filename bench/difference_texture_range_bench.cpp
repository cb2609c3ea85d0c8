#include "difference_texture_rows.hpp"
#include "problems/difference_texture_range.hpp"

namespace facezip::bench {
namespace {

void differenceTextureRange(benchmark::State& state) {
  benchDifferenceTexture<test::DifferenceTextureRangeProblem>(state);
}
BENCHMARK(differenceTextureRange)->Name("difference_texture_range")->Apply(differenceTextureArguments);

}  // namespace
}  // namespace facezip::bench
