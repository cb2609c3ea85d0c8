#include "problems/difference_texture_encode.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

/// Arguments: R, N, K. Four textures.
void differenceTextureEncode(benchmark::State& state) {
  const auto side = static_cast<int>(state.range(0));
  const auto mask_count = static_cast<int>(state.range(2));
  const test::BandShape shape{side, side, 3, static_cast<int>(state.range(1)), image::SampleType::kUint8};
  benchStep(state, test::DifferenceTextureEncodeProblem(benchDevice(), shape, test::bumpMasks(side, mask_count),
                                                        mask_count, 4, /* code_bits= */ 8));
}
BENCHMARK(differenceTextureEncode)
    ->Name("difference_texture_encode")
    ->ArgNames({"R", "N", "K"})
    ->Args({256, 20, 53})
    ->Args({1024, 20, 53})
    ->Args({2048, 8, 53})
    ->Args({1024, 20, 16})
    ->Args({1024, 20, 128})
    ->Args({512, 100, 53})
    ->Apply(milliseconds);

}  // namespace
}  // namespace facezip::bench
