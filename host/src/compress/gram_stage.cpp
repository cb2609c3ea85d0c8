#include "compress/gram_stage.hpp"

#include <algorithm>

#include "compress/search/gram.hpp"

namespace facezip::compress {
namespace {

// A change that the sample of a map's texels missed altogether leaves nothing to estimate by.
void lookAgain(CompressionState& state) {
  for (std::size_t m = 0; m < state.maps.maps.size(); ++m) {
    if (!state.rates->estimate().sawNothing(m)) continue;
    state.rates->estimate().startOver(m);
    OpenMap& map = state.maps.maps[m];
    const auto make_tiles = [&](int begin, int end) { return raster::coverageTiles(*map.raster, begin, end); };
    state.forEachBand(map, "estimating", make_tiles,
                      [&](const MapBand& band) { state.rates->estimate().addBand(m, band); });
  }
}

}  // namespace

void accumulateGrams(CompressionState& state) {
  state.covered_texels.assign(state.maps.maps.size(), 0);
  for (WeightGroup& group : state.groups) {
    GramAccumulator accumulator(state.context, state.gram_slots, state.expressions());
    for (OpenMap* map : group.maps) {
      std::uint64_t covered = 0;
      const auto make_tiles = [&](int begin, int end) {
        return state.weighed(state.texel_masks->tiles(*map->raster, begin, end, raster::TexelMasks::Texels::kCovered),
                             *map, begin);
      };
      state.forEachBand(*map, "Gram matrices", make_tiles, [&](const MapBand& band) {
        accumulator.add(band.tiles, band.differences, band.shape, map->fit_weight);
        if (state.rates) state.rates->estimate().addBand(static_cast<std::size_t>(map - state.maps.maps.data()), band);
        covered +=
            static_cast<std::uint64_t>(std::count_if(band.masks.texel_weights.begin(), band.masks.texel_weights.end(),
                                                     [](float weight) { return weight > 0.0f; }));
      });
      state.covered_texels[static_cast<std::size_t>(map - state.maps.maps.data())] = covered;
    }
    group.grams = accumulator.finish();
  }
  if (state.rates) lookAgain(state);
  state.report.covered_texels = state.covered_texels.front();
  state.report.overlapping_pairs = static_cast<int>(state.gram_slots.pairs.size());
  state.clock.book("Gram matrices");
}

}  // namespace facezip::compress
