#include "compress/fit_stage.hpp"

#include <algorithm>

#include "compress/codes/difference_texture_range.hpp"
#include "compress/compress_stretch.hpp"
#include "compress/refine/refinement.hpp"

namespace facezip::compress {
namespace {

/// Share of the weights at either end that may be clamped when they become bytes.
constexpr double kClippedWeights = 2e-4;

/// Mean energy of an expression's differences on a covered cell: what smoothness and trust are measured by.
double cellEnergy(const CompressionState& state, const WeightGroup& group) {
  const double energy = group.grams.slot(group.grams.slots.whole()).trace() / state.expressions();
  const auto cells = static_cast<double>(std::count(state.grid.covered.begin(), state.grid.covered.end(), 1));
  return energy > 0.0 ? energy / std::max(cells, 1.0) : 1.0;
}

}  // namespace

std::unique_ptr<TextureSource> directTextures(CompressionState& state, const WeightGroup& group) {
  if (state.options.method == CompressOptions::Method::kCompressStretch) {
    return std::make_unique<CompressStretchTextures>(state.context, state.weightSpace(), group.start);
  }
  return std::make_unique<ClusterTextures>(state.context, *state.texel_masks, group.coefficients);
}

void keepWeights(CompressionState& state, WeightGroup& group) {
  const std::unique_ptr<TextureSource> source = directTextures(state, group);
  TextureRangeFinder finder(state.context, state.options.differences);
  group.weights = group.start;
  group.ranges.assign(group.maps.size(), {});
  for (std::size_t m = 0; m < group.maps.size(); ++m) {
    OpenMap& map = *group.maps[m];
    state.forEachBand(map, "range of the differences", *source, [&](const MapBand& band) {
      const cl::Buffer& textures = source->compute(map, band);
      widen(group.ranges[m], finder.find(band.tiles, band.shape, textures, 0, band.tiles.tileCount()));
    });
  }
  state.clock.book("range of the differences");
}

void fitWeights(CompressionState& state, WeightGroup& group, int most_sweeps) {
  RefinementOptions refinement;
  refinement.most_sweeps = most_sweeps;
  RefinementProblem problem{state.weightSpace(), group.start, group.maps, {}, cellEnergy(state, group), 0};
  problem.make_tiles = [&state](const OpenMap& map, int begin, int end) {
    return state.weighed(raster::activeTiles(*map.classes, begin, end), map, begin);
  };
  state.buffers = std::make_unique<BandBuffers>(state.context);
  problem.window_rows = state.plannedWindowRows(group);
  Refinement refined = refine(state.context, problem, refinement, state.progress);
  group.ranges = std::move(refined.ranges);
  group.errors = std::move(refined.end_errors);
  group.start_error = refined.errors.front();
  if (most_sweeps > 0) {
    state.report.refinement_errors = std::move(refined.errors);
    group.weights = refined.weights.encode(state.grid.covered, kClippedWeights);
  } else {
    group.weights = group.start;
  }
  state.clock.book("refining");
}

}  // namespace facezip::compress
