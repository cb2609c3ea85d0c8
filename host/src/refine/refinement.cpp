#include "refine/refinement.hpp"

#include <algorithm>
#include <cassert>
#include <memory>
#include <numeric>

#include "io/counts.hpp"
#include "refine/difference_fit.hpp"
#include "refine/difference_texture_range.hpp"
#include "refine/tile_weights.hpp"
#include "refine/weight_system.hpp"
#include "refine/window_pass.hpp"

namespace facezip::compress {
namespace {

/// A map of the window, and the textures that suit its weights.
class FittedMap {
 public:
  FittedMap(device::DeviceContext& context, const GridMap& map, const WeightSpace& space)
      : window(context, map), fit(context, space), finder_(context, space.textures) {}

  double fitWeight() const { return window.map().fit_weight; }

  /// Squared error over the texels of the free rows themselves.
  FitError error() {
    const std::vector<FitError> errors = fit.errors();
    FitError sum;
    for (std::size_t t = window.firstOwnTile(); t < window.endOfOwnTiles(); ++t) {
      sum.weighted += errors[t].weighted;
      sum.plain += errors[t].plain;
    }
    return sum;
  }

  /// Of the free rows' tiles, [tile][plane].
  std::vector<TextureRange> ranges() {
    const GridBand band = window.band();
    return finder_.findPerTile(band.tiles, band.shape, fit.textures(), window.firstOwnTile(), window.endOfOwnTiles());
  }

  /// Remembers where the free rows' tiles lie: the next window may be prepared while this one is worked on.
  void keepTiles() {
    const auto& tiles = window.masks().tiles;
    own_tiles_.assign(tiles.begin() + static_cast<std::ptrdiff_t>(window.firstOwnTile()),
                      tiles.begin() + static_cast<std::ptrdiff_t>(window.endOfOwnTiles()));
    first_row_ = window.begin();
  }

  /// How far each plane of the free rows' tiles may be clamped for frames to change by `most`: [tile][plane].
  std::vector<float> clippable(const WeightWindow& weights, std::span<const float> values, float most) const {
    const std::size_t channels = toSize(window.map().map->samples->shape().channels);
    std::vector<float> reach;
    for (const float weight :
         largestWeights(own_tiles_, first_row_, window.map().weight_scale, weights.space(), weights.rows(), values)) {
      reach.insert(reach.end(), channels, most / std::max(weight, kLeastWeight));
    }
    return reach;
  }

  MapWindow window;
  DifferenceFit fit;

 private:
  static constexpr float kLeastWeight = 1e-3f;
  TextureRangeFinder finder_;
  std::vector<raster::TilePosition> own_tiles_;
  int first_row_ = 0;
};

/// What the sweeps over one window found.
struct WindowFit {
  std::vector<double> errors;                     ///< weighted, at the start and after each sweep
  std::vector<float> weights;                     ///< of the free rows, [row][column][C][lanes]
  std::vector<std::vector<TextureRange>> ranges;  ///< of every map, [tile][plane] of the free rows
  std::vector<std::vector<float>> clippable;      ///< how far they may be clamped, likewise
  std::vector<double> end_errors;                 ///< of every map, plain
};

/// The device's side of one window after the other.
class Sweeps {
 public:
  Sweeps(device::DeviceContext& context, const RefinementProblem& problem, const RefinementOptions& options)
      : problem_(problem),
        options_(options),
        window_(context, problem.space),
        system_(context, problem.space),
        halves_(context, problem.space),
        by_halves_(sweepsHalfCells(context, problem.maps) && options.most_sweeps > 0) {
    for (const GridMap& map : problem.maps) {
      maps_.push_back(std::make_unique<FittedMap>(context, map, problem.space));
    }
  }

  /// Reads the texels of rows [begin, end) of cells. May run beside sweep() on the window before.
  void prepare(int begin, int end) {
    for (const auto& map : maps_) map->window.prepare(begin, end, problem_.make_tiles);
  }

  /// Puts what was prepared on the device. done  weights of the rows of cells above
  void load(int begin, int end, const GridWeights& done) {
    WindowRows rows{begin, end, begin, end};
    for (const auto& map : maps_) {
      map->window.load();
      map->keepTiles();
      const raster::CellRows reached = map->window.cellRows(problem_.space.rows);
      rows.begin = std::min(rows.begin, reached.begin);
      rows.end = std::max(rows.end, reached.end);
    }
    moveWindow(window_, rows, problem_.start, done);
    if (!by_halves_) return;
    halves_.moveTo(rows);
    for (const auto& map : maps_) halves_.add(map->window.band(), map->window.tileAt(), map->fitWeight());
  }

  WindowFit sweep(const Progress& progress) {
    WindowFit found;
    double error = fit();
    found.errors.push_back(error);
    bool done = false;
    for (int sweep = 1; sweep <= options_.most_sweeps; ++sweep) {
      if (!done) {
        progress.checkCancelled();
        solveWeights();
        const double before = error;
        error = fit();
        done = before - error < options_.least_gain * before;
      }
      found.errors.push_back(error);
    }
    if (by_halves_) turnOnTexels();
    found.weights = freeWeights(window_);
    const std::vector<float> weights = window_.weights();
    for (const auto& map : maps_) {
      found.clippable.push_back(map->clippable(window_, weights, static_cast<float>(options_.most_clipped)));
      found.ranges.push_back(map->ranges());
      found.end_errors.push_back(map->error().plain);
    }
    return found;
  }

 private:
  /// Fits the difference textures to every texel; returns the squared error, texel and metric weights in it.
  double fitTexels() {
    const float ridge = ridgeOf(options_, problem_.space);
    for (const auto& map : maps_) map->fit.compute(map->window.band(), window_, ridge);
    double error = 0.0;
    for (const auto& map : maps_) error += map->fitWeight() * map->error().weighted;
    return error;
  }

  /// The same on what the sweeps see of the textures.
  double fit() {
    if (!by_halves_) return fitTexels();
    halves_.fit(window_, ridgeOf(options_, problem_.space));
    return halves_.error();
  }

  /// What half cells could not see: the weights' slope inside them.
  void turnOnTexels() {
    fitTexels();
    addTexels();
    relax();
    fitTexels();
  }

  void solveWeights() {
    if (by_halves_) {
      system_.gather(halves_, window_);
    } else {
      addTexels();
    }
    relax();
  }

  void addTexels() {
    system_.clear();
    for (const auto& map : maps_) {
      system_.add(map->window.band(), map->window.tileAt(), map->fit.textures(), window_, map->fitWeight());
    }
  }

  void relax() {
    system_.relax(window_, options_.relax_sweeps, static_cast<float>(options_.smoothness * problem_.cell_energy),
                  static_cast<float>(options_.trust * problem_.cell_energy));
  }

  const RefinementProblem& problem_;
  const RefinementOptions& options_;
  WeightWindow window_;
  WeightSystem system_;
  HalfCells halves_;
  bool by_halves_;
  std::vector<std::unique_ptr<FittedMap>> maps_;
};

}  // namespace

bool sweepsHalfCells(const device::DeviceContext& context, std::span<const GridMap> maps) {
  return context.resolve(device::KernelVariant::kAuto) == device::KernelVariant::kCpu &&
         std::ranges::all_of(maps, [](const GridMap& map) { return HalfCells::canHold(map.weight_scale); });
}

Refinement refine(device::DeviceContext& context, const RefinementProblem& problem, const RefinementOptions& options,
                  Progress& progress) {
  assert(problem.cell_energy > 0.0 && problem.window_rows > 0);
  Refinement result(problem.space);
  result.errors.assign(toSize(options.most_sweeps) + 1, 0.0);
  result.end_errors.assign(problem.maps.size(), 0.0);
  std::vector<std::vector<TextureRange>> tile_ranges(problem.maps.size());  // [tile][plane]
  std::vector<std::vector<float>> clippable(problem.maps.size());           // likewise
  const int rows = problem.space.rows;
  progress.stage("refining", toSize(rows));
  Sweeps sweeps(context, problem, options);
  const auto load = [&](int begin, int end) { sweeps.load(begin, end, result.weights); };
  const auto work = [&](int begin, int end) {
    const WindowFit fit = sweeps.sweep(progress);
    result.weights.store(begin, end, fit.weights);
    for (std::size_t i = 0; i < fit.errors.size(); ++i) result.errors[i] += fit.errors[i];
    for (std::size_t m = 0; m < problem.maps.size(); ++m) {
      tile_ranges[m].insert(tile_ranges[m].end(), fit.ranges[m].begin(), fit.ranges[m].end());
      clippable[m].insert(clippable[m].end(), fit.clippable[m].begin(), fit.clippable[m].end());
      result.end_errors[m] += fit.end_errors[m];
    }
    progress.advance(toSize(end));
  };
  forEachWindow(
      rows, problem.window_rows, [&](int begin, int end) { sweeps.prepare(begin, end); }, load, work);
  // The start is kept whole: it is what is left where clamping costs too much.
  const double clipped = options.most_sweeps > 0 ? options.clipped_tiles : 0.0;
  for (std::size_t m = 0; m < problem.maps.size(); ++m) {
    const std::size_t planes = toSize(problem.space.textures, problem.maps[m].map->samples->shape().channels);
    result.ranges.push_back(clippedRange(tile_ranges[m], planes, clipped, clippable[m]));
  }
  return result;
}

float ridgeOf(const RefinementOptions& options, const WeightSpace& space) {
  return static_cast<float>(options.ridge * space.expressions / space.textures);
}

int windowRowStep(std::span<const GridMap> maps) {
  int step = 1;
  for (const GridMap& map : maps) step = std::lcm(step, kTileSide / std::gcd(kTileSide, map.weight_scale));
  return step;
}

}  // namespace facezip::compress
