#include "codes/coded_refinement.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "io/counts.hpp"
#include "refine/weight_system.hpp"
#include "refine/window_pass.hpp"

namespace facezip::compress {
namespace {

int rowStep(const CodedMap& map) {
  if (map.neutral == nullptr) return 1;
  std::vector<blocks::BlockFormat> formats = map.coding.formats;
  formats.push_back(map.neutral->format);
  return blockRowStep(formats);
}

/// A map of the window, and its difference textures as they are decoded.
class WindowMap {
 public:
  WindowMap(device::DeviceContext& context, const CodedMap& map, const WeightSpace& space)
      : window(context, map.map, rowStep(map)) {
    if (map.neutral == nullptr) {
      fit_.emplace(context, space);
    } else {
      coded_.emplace(context, space, map.coding, blocks::Quality::kFast, false);
      neutral_.emplace(*map.neutral);
    }
  }

  void load() {
    if (!coded_) return window.load();
    coded_->setTiles(window.masks());
    window.load(neutral_->rows(window.begin(), window.end()));
  }

  const cl::Buffer& textures(const WeightWindow& weights, float ridge) {
    return coded_ ? coded_->compute(window.band(), weights, ridge) : fit_->compute(window.band(), weights, ridge);
  }

  MapWindow window;

 private:
  std::optional<DifferenceFit> fit_;  // of images
  std::optional<CodedTextures> coded_;
  std::optional<DecodedNeutral> neutral_;
};

class CodedSweeps {
 public:
  CodedSweeps(device::DeviceContext& context, const CodedProblem& problem, const RefinementOptions& options)
      : problem_(problem), options_(options), window_(context, problem.space), system_(context, problem.space) {
    for (const CodedMap& map : problem.maps) maps_.push_back(std::make_unique<WindowMap>(context, map, problem.space));
  }

  void prepare(int begin, int end) {
    for (const auto& map : maps_) map->window.prepare(begin, end, problem_.make_tiles);
  }

  void load(int begin, int end, const GridWeights& done) {
    WindowRows rows{begin, end, begin, end};
    for (const auto& map : maps_) {
      map->load();
      const raster::CellRows reached = map->window.cellRows(problem_.space.rows);
      rows.begin = std::min(rows.begin, reached.begin);
      rows.end = std::max(rows.end, reached.end);
    }
    moveWindow(window_, rows, problem_.start, done);
  }

  std::vector<float> sweep(int turns, const Progress& progress) {
    const float ridge = ridgeOf(options_, problem_.space);
    for (int turn = 0; turn < turns; ++turn) {
      system_.clear();
      for (const auto& map : maps_) {
        progress.checkCancelled();
        const cl::Buffer& textures = map->textures(window_, ridge);
        system_.add(map->window.band(), map->window.tileAt(), textures, window_, map->window.map().fit_weight);
      }
      system_.relax(window_, options_.relax_sweeps, static_cast<float>(options_.smoothness * problem_.cell_energy),
                    static_cast<float>(options_.trust * problem_.cell_energy));
    }
    return freeWeights(window_);
  }

 private:
  const CodedProblem& problem_;
  const RefinementOptions& options_;
  WeightWindow window_;
  WeightSystem system_;
  std::vector<std::unique_ptr<WindowMap>> maps_;
};

}  // namespace

GridWeights refineCoded(device::DeviceContext& context, const CodedProblem& problem, const RefinementOptions& options,
                        int turns, Progress& progress) {
  GridWeights weights(problem.space);
  progress.stage("fitting to blocks", toSize(problem.space.rows));
  CodedSweeps sweeps(context, problem, options);
  const auto load = [&](int begin, int end) { sweeps.load(begin, end, weights); };
  const auto work = [&](int begin, int end) {
    weights.store(begin, end, sweeps.sweep(turns, progress));
    progress.advance(toSize(end));
  };
  forEachWindow(
      problem.space.rows, problem.window_rows, [&](int b, int e) { sweeps.prepare(b, e); }, load, work);
  return weights;
}

}  // namespace facezip::compress
