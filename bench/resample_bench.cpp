#include "problems/resample.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

/// Arguments: side of the scan's texture, side of the template's layout.
void resample(benchmark::State& state) {
  benchStep(state, test::ResampleProblem(benchDevice(), {.width = static_cast<int>(state.range(0)),
                                                         .height = static_cast<int>(state.range(0)),
                                                         .channels = 3,
                                                         .type = image::SampleType::kUint8,
                                                         .count = toSize(state.range(1), state.range(1))}));
}
BENCHMARK(resample)
    ->Name("resample")
    ->ArgNames({"source", "R"})
    ->Args({512, 256})
    ->Args({1024, 1024})
    ->Args({4096, 2048})
    ->Apply(milliseconds);

}  // namespace
}  // namespace facezip::bench
