#include <benchmark/benchmark.h>

#include "compress/search/counter_hash.hpp"
#include "compress/search/weight_map.hpp"
#include "roof.hpp"

namespace facezip::bench {
namespace {

/// Seven masks in every cell, of K that lie in order along the cells.
compress::CellMasks makeCells(std::size_t count, int masks) {
  constexpr int kActive = 7;
  compress::CellMasks cells{{0}, {}, {}};
  for (std::size_t p = 0; p < count; ++p) {
    const int first = static_cast<int>(p * static_cast<std::size_t>(masks - kActive) / count);
    for (int j = 0; j < kActive; ++j) {
      cells.mask_index.push_back(first + j);
      cells.mask_weights.push_back(1.0f / kActive);
    }
    cells.cell_begin.push_back(static_cast<int>(cells.mask_index.size()));
  }
  return cells;
}

/// Arguments: side of the weight map, N, K. The kernel alone; must move: the masks of the cells once in, the bytes once
/// out.
void weightMap(benchmark::State& state) {
  constexpr int kClusters = 4;
  device::DeviceContext& context = benchDevice();
  const auto cells = static_cast<std::size_t>(state.range(0) * state.range(0));
  const int expressions = static_cast<int>(state.range(1)), mask_count = static_cast<int>(state.range(2));
  const compress::CellMasks masks = makeCells(cells, mask_count);
  std::vector<int> texture_of;
  for (int i = 0; i < mask_count * expressions; ++i) {
    texture_of.push_back(static_cast<int>(compress::counterHash(1, static_cast<std::uint64_t>(i), 0, 0) % kClusters));
  }
  const std::size_t bytes = cells * static_cast<std::size_t>(expressions) * kClusters;
  const compress::WeightMapLaunch launch{
      .cells = cells,
      .expressions = expressions,
      .clusters = kClusters,
      .first_entry = 0,
      .cell_begin = context.upload(masks.cell_begin, "cells"),
      .mask_index = context.upload(masks.mask_index, "masks"),
      .mask_weights = context.upload(masks.mask_weights, "weights"),
      .texture_of = context.upload(compress::packTextureOf(texture_of, mask_count, expressions), "textures"),
      .weights = context.allocate(bytes, CL_MEM_WRITE_ONLY, "weight maps")};
  measure(state, [&] {
    compress::launchWeightMap(context, launch);
    context.finish();
  });
  setBandwidthCounters(state, static_cast<double>(bytes + 8 * masks.mask_index.size() + 4 * masks.cell_begin.size()));
}
BENCHMARK(weightMap)
    ->Name("weight_map")
    ->ArgNames({"side", "N", "K"})
    ->Args({32, 20, 53})
    ->Args({128, 8, 16})
    ->Args({128, 20, 53})
    ->Args({256, 52, 53})
    ->Args({256, 100, 128})
    ->Args({512, 8, 53})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace facezip::bench
