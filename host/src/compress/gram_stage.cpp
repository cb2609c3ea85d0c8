#include "compress/gram_stage.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "search/gram.hpp"

namespace facezip::compress {
namespace {

std::uint64_t countCovered(const TileMasks& tiles) {
  return static_cast<std::uint64_t>(std::ranges::count_if(tiles.texel_weights, [](float w) { return w > 0.0f; }));
}

}  // namespace

GramStage accumulateGrams(const std::vector<std::vector<GridMap>>& groups, const raster::TexelMasks& masks,
                          const GramSlots& slots, const std::optional<Importance>& importance, int band_rows,
                          const ObserveBand& observe, const device::Run& run) {
  GramStage stage;
  BandBuffers buffers(run.context);
  for (const std::vector<GridMap>& group : groups) {
    GramAccumulator accumulator(run.context, slots, group.front().map->samples->expressions());
    for (const GridMap& map : group) {
      const raster::UvRaster& raster = *map.map->raster;
      std::uint64_t covered = 0;
      const auto make_tiles = [&](int begin, int end) {
        return weighed(masks.tiles(raster, begin, end, raster::TexelMasks::Texels::kCovered), importance,
                       map.map->samples->shape(), begin);
      };
      const auto add = [&](const MapBand& band) {
        accumulator.add(band.tiles, band.differences, band.shape, map.fit_weight);
        observe(map.index, band);
        covered += countCovered(band.masks);
      };
      forEachMapBand(*map.map->samples, band_rows, buffers, make_tiles,
                     fmt::format("Gram matrices: {}", map.map->source->name), run.progress, add);
      stage.covered_texels.resize(std::max(stage.covered_texels.size(), map.index + 1));
      stage.covered_texels[map.index] = covered;
      stage.fit_weights.resize(stage.covered_texels.size());
      stage.fit_weights[map.index] = map.fit_weight;
    }
    stage.grams.push_back(accumulator.finish());
  }
  run.clock.book("Gram matrices");
  return stage;
}

GramMatrices sumOf(const GramStage& stage, const std::vector<GridMap>& maps) {
  GramMatrices sum = stage.grams.front();
  std::ranges::fill(sum.values, 0.0);
  for (const GridMap& map : maps) {
    const double factor = map.fit_weight / stage.fit_weights[map.index];  // by itself no map weighs nothing
    const std::vector<double>& values = stage.grams[map.index].values;
    for (std::size_t i = 0; i < values.size(); ++i) sum.values[i] += factor * values[i];
  }
  return sum;
}

}  // namespace facezip::compress
