#include "compress/fit_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "refine/difference_texture_range.hpp"
#include "refine/refinement.hpp"

namespace facezip::compress {
namespace {

/// When weights become bytes: one in 5,000 may be clamped, by half a texture at most.
constexpr Clipping kWeightClipping{2e-4, 0.5f};

}  // namespace

double cellEnergy(const FitProblem& problem) {
  const double energy = problem.energy / problem.space.expressions;
  const auto cells = static_cast<double>(std::ranges::count(problem.covered, 1));
  return energy > 0.0 ? energy / std::max(cells, 1.0) : 1.0;
}

MakeMapTiles weighedTiles(const FitProblem& problem) {
  return [&problem](const OpenMap& map, int begin, int end) {
    return weighed(raster::activeTiles(*map.classes, begin, end), problem.importance, map.samples->shape(), begin);
  };
}

EncodedWeights encodeFitted(const GridWeights& weights, const FitProblem& problem) {
  return weights.encode(problem.covered, kWeightClipping);
}

FittedWeights fitWeights(const FitProblem& problem, int most_sweeps, const device::Run& run) {
  RefinementOptions options;
  options.most_sweeps = most_sweeps;
  // What one texture's codes clamp, the blocks of those after it take up; and a wide range coarsens the ends of every
  // block.
  if (problem.in_blocks) options.most_clipped = std::numeric_limits<double>::infinity();
  const RefinementProblem refinement{problem.space,         problem.start,       problem.maps,
                                     weighedTiles(problem), cellEnergy(problem), problem.window_rows};
  Refinement refined = refine(run.context, refinement, options, run.progress);
  FittedWeights fitted;
  fitted.weights = most_sweeps > 0 ? encodeFitted(refined.weights, problem) : problem.start;
  fitted.ranges = std::move(refined.ranges);
  fitted.errors = std::move(refined.end_errors);
  fitted.sweep_errors = std::move(refined.errors);
  run.clock.book("refining");
  return fitted;
}

FittedWeights keepWeights(const EncodedWeights& weights, std::span<const GridMap> maps, int differences,
                          TextureSource& textures, int band_rows, const device::Run& run) {
  FittedWeights kept;
  kept.weights = weights;
  BandBuffers buffers(run.context);
  TextureRangeFinder finder(run.context, differences);
  for (const GridMap& map : maps) {
    std::vector<TextureRange>& ranges = kept.ranges.emplace_back();
    const auto make_tiles = [&](int begin, int end) { return textures.tiles(*map.map, begin, end); };
    const auto find = [&](const MapBand& band) {
      const cl::Buffer& computed = textures.compute(map, band);
      widen(ranges, finder.find(band.tiles, band.shape, computed, 0, band.tiles.tileCount()));
    };
    forEachMapBand(*map.map->samples, band_rows, buffers, make_tiles,
                   fmt::format("range of the differences: {}", map.map->source->name), run.progress, find);
  }
  run.clock.book("range of the differences");
  return kept;
}

}  // namespace facezip::compress
