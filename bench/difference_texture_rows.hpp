// difference_texture_rows.hpp - sizes of the rows of the steps from masks to difference textures and their codes.
#pragma once

#include "problems/difference_texture.hpp"
#include "roof.hpp"

namespace facezip::bench {

/// Arguments: R, N, K. Four textures of a square map of three channels of 8 bits; more: what the problem takes behind.
template <typename Problem, typename... More>
void benchDifferenceTexture(benchmark::State& state, const More&... more) {
  const auto side = static_cast<int>(state.range(0));
  const auto mask_count = static_cast<int>(state.range(2));
  const test::BandShape shape{side, side, 3, static_cast<int>(state.range(1)), image::SampleType::kUint8};
  benchStep(state, Problem(benchDevice(), shape, test::bumpMasks(side, mask_count), mask_count, 4, more...));
}

inline void differenceTextureArguments(benchmark::internal::Benchmark* row) {
  row->ArgNames({"R", "N", "K"})->Apply(milliseconds);
  row->Args({256, 20, 53})->Args({1024, 20, 53})->Args({2048, 8, 53});
  row->Args({1024, 20, 16})->Args({1024, 20, 128})->Args({512, 100, 53});
}

}  // namespace facezip::bench
