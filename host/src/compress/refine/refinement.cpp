#include "compress/refine/refinement.hpp"

#include <algorithm>
#include <cassert>
#include <future>
#include <memory>
#include <numeric>

#include "compress/bands/difference.hpp"
#include "compress/bands/map_bands.hpp"
#include "compress/codes/difference_texture_range.hpp"
#include "compress/refine/difference_fit.hpp"
#include "compress/refine/weight_system.hpp"
#include "image/sample_window.hpp"

namespace facezip::compress {
namespace {

/// One map of the window on the device.
class MapWindow {
 public:
  MapWindow(device::DeviceContext& context, const GridMap& map, const WeightSpace& space)
      : map_(map),
        context_(context),
        textures_(space.textures),
        window_(*map.map->samples),
        tiles_(context),
        samples_(context, "samples of a band", CL_MEM_READ_ONLY),
        differences_(context, "differences of a band"),
        tile_at_(context, "lookup of tiles", CL_MEM_READ_ONLY),
        fit_(context, space),
        finder_(context, space.textures) {}

  double fitWeight() const { return map_.fit_weight; }

  /// Reads the texels that rows [free_begin, free_end) of cells reach into host memory. May run beside the device's
  /// work on the window before.
  void prepare(int free_begin, int free_end, const RefinementProblem& problem) {
    const int height = map_.map->samples->shape().height;
    const int halo = windowHalo(map_.weight_scale);
    own_begin_ = std::min(free_begin * map_.weight_scale, height);
    own_end_ = std::min(free_end * map_.weight_scale, height);
    window_.moveTo(std::max(0, own_begin_ - halo), std::min(height, own_end_ + halo));
    masks_ = problem.make_tiles(*map_.map, window_.begin(), window_.end());
  }

  /// Puts what was prepared on the device.
  void load() {
    shape_ = bandShape(*map_.map->samples, window_.end() - window_.begin());
    first_row_ = window_.begin();
    const auto first_behind = [&](int row) {
      return static_cast<std::size_t>(
          std::partition_point(masks_.tiles.begin(), masks_.tiles.end(),
                               [&](const TilePosition& tile) { return first_row_ + tile.y * kTileSide < row; }) -
          masks_.tiles.begin());
    };
    first_own_tile_ = first_behind(own_begin_);
    end_of_own_tiles_ = first_behind(own_end_);
    tiles_.upload(masks_);
    tile_at_.upload(tileLookup(masks_, shape_));
    const cl::Buffer& raw = samples_.upload(window_.samples());
    differences_.reserve(differenceBufferBytes(shape_, masks_.tiles.size()));
    computeDifferences(context_, tiles_, shape_, raw, differences_.buffer());
  }

  void fit(const WeightWindow& weights, float ridge) { fit_.compute(band(), weights, ridge); }

  /// Squared error over the texels of the free rows themselves.
  FitError error() {
    const std::vector<FitError> errors = fit_.errors();
    FitError sum;
    for (std::size_t t = first_own_tile_; t < end_of_own_tiles_; ++t) {
      sum.weighted += errors[t].weighted;
      sum.plain += errors[t].plain;
    }
    return sum;
  }

  void addTo(HalfCells& halves) { halves.add(band(), tile_at_.buffer(), fitWeight()); }
  void addTo(WeightSystem& system, const WeightWindow& weights) {
    system.add(band(), tile_at_.buffer(), fit_.textures(), weights, fitWeight());
  }

  /// Of the free rows' tiles, [tile][plane].
  std::vector<TextureRange> ranges() {
    return finder_.findPerTile(tiles_, shape_, fit_.textures(), first_own_tile_, end_of_own_tiles_);
  }
  std::size_t planes() const { return static_cast<std::size_t>(textures_ * map_.map->samples->shape().channels); }

 private:
  GridBand band() const { return {tiles_, shape_, differences_.buffer(), first_row_, map_.weight_scale}; }

  GridMap map_;
  device::DeviceContext& context_;
  int textures_;
  // What prepare() makes.
  image::SampleWindow window_;
  TileMasks masks_;
  int own_begin_ = 0;  ///< texel rows of the free cells
  int own_end_ = 0;
  // What is on the device.
  BandShape shape_;
  int first_row_ = 0;
  DeviceTiles tiles_;
  device::PooledBuffer samples_;
  device::PooledBuffer differences_;
  device::PooledBuffer tile_at_;
  DifferenceFit fit_;
  TextureRangeFinder finder_;
  std::size_t first_own_tile_ = 0;
  std::size_t end_of_own_tiles_ = 0;
};

class Refiner {
 public:
  Refiner(device::DeviceContext& context, const RefinementProblem& problem, const RefinementOptions& options)
      : context_(context),
        problem_(problem),
        options_(options),
        window_(context, problem.space),
        system_(context, problem.space),
        halves_(context, problem.space),
        by_halves_(sweepsHalfCells(context, problem.maps)),
        result_(problem.space) {
    assert(problem.cell_energy > 0.0 && problem.window_rows > 0);
    for (const GridMap& map : problem.maps) {
      maps_.push_back(std::make_unique<MapWindow>(context, map, problem.space));
    }
    result_.ranges.resize(maps_.size());
    tile_ranges_.resize(maps_.size());
    result_.end_errors.resize(maps_.size(), 0.0);
    result_.errors.assign(static_cast<std::size_t>(options.most_sweeps) + 1, 0.0);
  }

  Refinement run(Progress& progress) {
    const int rows = problem_.space.rows;
    progress.stage("refining", static_cast<std::size_t>(rows));
    std::future<void> ahead;  // reads the window after the one at work
    prepare(0);
    for (int begin = 0; begin < rows; begin += problem_.window_rows) {
      const int end = std::min(begin + problem_.window_rows, rows);
      if (ahead.valid()) ahead.get();
      moveTo(begin, end);
      if (end < rows) ahead = std::async(std::launch::async, [this, end] { prepare(end); });
      sweep(progress);
      keep();
      progress.advance(static_cast<std::size_t>(end));
    }
    // The start is kept whole: it is what is left where clamping costs too much.
    const double clipped = options_.most_sweeps > 0 ? options_.clipped_tiles : 0.0;
    for (std::size_t m = 0; m < maps_.size(); ++m) {
      result_.ranges[m] = clippedRange(tile_ranges_[m], maps_[m]->planes(), clipped);
    }
    return std::move(result_);
  }

 private:
  void prepare(int begin) {
    const int end = std::min(begin + problem_.window_rows, problem_.space.rows);
    for (const auto& map : maps_) map->prepare(begin, end, problem_);
  }

  void moveTo(int begin, int end) {
    WindowRows rows{begin, end, begin, end};
    for (std::size_t m = 0; m < maps_.size(); ++m) {
      maps_[m]->load();
      const int scale = problem_.maps[m].weight_scale;
      const int halo = windowHalo(scale);
      const WindowRows reached =
          cellRowsOf(std::max(0, begin * scale - halo), end * scale + halo, scale, problem_.space.rows);
      rows.begin = std::min(rows.begin, reached.begin);
      rows.end = std::max(rows.end, reached.end);
    }
    const std::size_t row_floats = problem_.space.rowFloats();
    std::vector<float> start(static_cast<std::size_t>(rows.count()) * row_floats);
    decodeRows(problem_.start, problem_.space, rows.begin, rows.end, start);
    std::vector<float> weights = start;
    result_.weights.load(rows.begin, begin,
                         std::span(weights).first(static_cast<std::size_t>(begin - rows.begin) * row_floats));
    window_.set(rows, weights, start);
    if (!by_halves_ || options_.most_sweeps == 0) return;
    halves_.moveTo(rows);
    for (const auto& map : maps_) map->addTo(halves_);
  }

  /// Fits the difference textures to every texel; returns the squared error, texel and metric weights in it.
  double fitTexels() {
    const float ridge = ridgeOf(options_, problem_.space);
    for (const auto& map : maps_) map->fit(window_, ridge);
    double error = 0.0;
    for (const auto& map : maps_) error += map->fitWeight() * map->error().weighted;
    return error;
  }

  /// The same on what the sweeps see of the textures.
  double fit() {
    if (!by_halves_ || options_.most_sweeps == 0) return fitTexels();
    halves_.fit(window_, ridgeOf(options_, problem_.space));
    return halves_.error();
  }

  void sweep(Progress& progress) {
    double error = fit();
    result_.errors[0] += error;
    bool done = false;
    for (int sweep = 1; sweep <= options_.most_sweeps; ++sweep) {
      if (!done) {
        progress.checkCancelled();
        solveWeights();
        const double before = error;
        error = fit();
        done = before - error < options_.least_gain * before;
      }
      result_.errors[static_cast<std::size_t>(sweep)] += error;
    }
    if (by_halves_ && options_.most_sweeps > 0) turnOnTexels();
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
    for (const auto& map : maps_) map->addTo(system_, window_);
  }

  void relax() {
    system_.relax(window_, options_.relax_sweeps, static_cast<float>(options_.smoothness * problem_.cell_energy),
                  static_cast<float>(options_.trust * problem_.cell_energy));
  }

  void keep() {
    const WindowRows& rows = window_.rows();
    const std::size_t row_floats = problem_.space.rowFloats();
    const std::vector<float> weights = window_.weights();
    result_.weights.store(
        rows.free_begin, rows.free_end,
        std::span(weights).subspan(static_cast<std::size_t>(rows.free_begin - rows.begin) * row_floats,
                                   static_cast<std::size_t>(rows.free_end - rows.free_begin) * row_floats));
    for (std::size_t m = 0; m < maps_.size(); ++m) {
      const std::vector<TextureRange> tiles = maps_[m]->ranges();
      tile_ranges_[m].insert(tile_ranges_[m].end(), tiles.begin(), tiles.end());
      result_.end_errors[m] += maps_[m]->error().plain;
    }
  }

  device::DeviceContext& context_;
  const RefinementProblem& problem_;
  const RefinementOptions& options_;
  WeightWindow window_;
  WeightSystem system_;
  HalfCells halves_;
  bool by_halves_;
  std::vector<std::unique_ptr<MapWindow>> maps_;
  std::vector<std::vector<TextureRange>> tile_ranges_;  ///< of every map, [tile][plane]
  Refinement result_;
};

}  // namespace

bool sweepsHalfCells(const device::DeviceContext& context, std::span<const GridMap> maps) {
  return context.resolve(device::KernelVariant::kAuto) == device::KernelVariant::kCpu &&
         std::ranges::all_of(maps, [](const GridMap& map) { return HalfCells::canHold(map.weight_scale); });
}

Refinement refine(device::DeviceContext& context, const RefinementProblem& problem, const RefinementOptions& options,
                  Progress& progress) {
  return Refiner(context, problem, options).run(progress);
}

float ridgeOf(const RefinementOptions& options, const WeightSpace& space) {
  return static_cast<float>(options.ridge * space.expressions / space.textures);
}

int windowRowStep(std::span<const GridMap> maps) {
  int step = 1;
  for (const GridMap& map : maps) step = std::lcm(step, kTileSide / std::gcd(kTileSide, map.weight_scale));
  return step;
}

int windowHalo(int weight_scale) { return ((weight_scale + 1) / 2 + kTileSide - 1) / kTileSide * kTileSide; }

}  // namespace facezip::compress
