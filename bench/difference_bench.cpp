#include "problems/difference.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

/// Arguments: R, N.
void difference(benchmark::State& state) {
  const auto side = static_cast<int>(state.range(0));
  const test::BandShape shape{side, side, 3, static_cast<int>(state.range(1)), image::SampleType::kUint8};
  benchStep(state, test::DifferenceProblem(benchDevice(), shape, test::wholeBand(shape)));
}
BENCHMARK(difference)
    ->ArgNames({"R", "N"})
    ->Args({256, 20})
    ->Args({1024, 8})
    ->Args({1024, 20})
    ->Args({1024, 52})
    ->Args({1024, 100})
    ->Args({2048, 20})
    ->Args({4096, 8})
    ->Apply(milliseconds);

}  // namespace
}  // namespace facezip::bench
