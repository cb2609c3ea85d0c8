#include "rig/shape_codes.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "package/weight_atlas.hpp"
#include "raster/cell_samples.hpp"

namespace facezip::rig {
namespace {

/// Cells whose shapes say how far the codes must reach, and the share of their weights at either end that need not be.
constexpr std::size_t kCellsToReach = 4096;
constexpr double kUnreached = 0.005;
/// Share of the captured weights' range by which the codes may reach farther at either end. Eq. 11 as it is printed
/// amplifies: its shapes need all they ask for, or they do not add up to the captured expressions (Eq. 10).
constexpr double kFarther = 0.5;
constexpr double kFartherByPseudoInverse = 2.0;

class ShapeSolver {
 public:
  ShapeSolver(const Package& package, int set, const TextureSolver& solver, const SkinFeatures& features,
              const compress::GridMap& map)
      : captured_(decodeSet(package, set)),
        grid_(package.weightSets()[static_cast<std::size_t>(set)]),
        channels_(static_cast<std::size_t>(package.differences())),
        solver_(solver),
        features_(features),
        samples_(raster::cellSamples(*map.map->raster, map.weight_scale)),
        source_(raster::nearestSampled(samples_, grid_.tile_width, grid_.tile_height)),
        result_{grid_.scale, grid_.offset, {}, 0.0} {
    if (solver.method != TextureSolve::kLocal) everywhere_ = globalSolution(solver);
  }

  ShapeCodes run(Progress& progress) {
    reachFarther();
    const auto columns = static_cast<std::size_t>(grid_.tile_width), rows = static_cast<std::size_t>(grid_.tile_height);
    result_.codes.resize(static_cast<std::size_t>(captured_.cols() + solver_.weights.cols()) * cells() * channels_);
    std::vector<std::size_t> clamped(cells(), 0);
    progress.stage("textures of shapes", rows);
    for (std::size_t row = 0; row < rows; ++row) {
      progress.checkCancelled();
      tbb::parallel_for(row * columns, (row + 1) * columns, [&](std::size_t cell) {
        encode(capturedOf(cell), cell, 0);
        clamped[cell] = encode(shapesOf(cell), cell, static_cast<std::size_t>(captured_.cols()));
      });
      progress.advance(row + 1);
    }
    std::size_t values = 0, beyond = 0;
    for (std::size_t cell = 0; cell < cells(); ++cell) {
      if (samples_[cell].triangle < 0) continue;
      values += static_cast<std::size_t>(solver_.weights.cols()) * channels_;
      beyond += clamped[cell];
    }
    if (values > 0) result_.clamped = static_cast<double>(beyond) / static_cast<double>(values);
    return std::move(result_);
  }

 private:
  std::size_t cells() const { return samples_.size(); }

  /// C by N.
  Eigen::MatrixXf capturedOf(std::size_t cell) const {
    return captured_.middleRows(static_cast<Eigen::Index>(cell * channels_), static_cast<Eigen::Index>(channels_));
  }

  /// C by M: the cell's own captured weights mixed as the nearest sampled cell says.
  Eigen::MatrixXf shapesOf(std::size_t cell) const {
    const int from = source_[cell];
    if (from < 0) return Eigen::MatrixXf::Zero(static_cast<Eigen::Index>(channels_), solver_.weights.cols());
    if (everywhere_.size() > 0) return capturedOf(cell) * everywhere_.transpose().cast<float>();
    const Eigen::MatrixXd solution = localSolution(solver_, features_.at(samples_[static_cast<std::size_t>(from)]));
    return capturedOf(cell) * solution.transpose().cast<float>();
  }

  void reachFarther() {
    if (solver_.method == TextureSolve::kPseudoInverse) {
      reachAll();
    } else {
      reachMost();
    }
  }

  /// As far as any weight of a shape goes, in any cell.
  void reachAll() {
    const auto count = static_cast<Eigen::Index>(channels_);
    Eigen::ArrayXf low = Eigen::ArrayXf::Constant(count, std::numeric_limits<float>::infinity()), high = -low;
    for (std::size_t cell = 0; cell < cells(); ++cell) {
      const Eigen::MatrixXf shapes = shapesOf(cell);
      if (!shapes.allFinite()) continue;
      low = low.min(shapes.rowwise().minCoeff().array());
      high = high.max(shapes.rowwise().maxCoeff().array());
    }
    for (Eigen::Index c = 0; c < count; ++c) {
      if (low[c] <= high[c]) reach(low[c], high[c], kFartherByPseudoInverse, static_cast<std::size_t>(c));
    }
  }

  /// As far as nearly all go, in a sample of cells.
  void reachMost() {
    std::vector<std::size_t> covered;
    for (std::size_t cell = 0; cell < cells(); ++cell) {
      if (samples_[cell].triangle >= 0) covered.push_back(cell);
    }
    const std::size_t stride = std::max<std::size_t>(1, covered.size() / kCellsToReach);
    std::vector<std::vector<float>> weights(channels_);
    for (std::size_t i = 0; i < covered.size(); i += stride) {
      const Eigen::MatrixXf shapes = shapesOf(covered[i]);
      for (std::size_t c = 0; c < channels_; ++c) {
        for (const float weight : shapes.row(static_cast<Eigen::Index>(c))) {
          if (std::isfinite(weight)) weights[c].push_back(weight);
        }
      }
    }
    for (std::size_t c = 0; c < channels_; ++c) {
      if (weights[c].empty()) continue;
      const auto end = static_cast<std::ptrdiff_t>(kUnreached * static_cast<double>(weights[c].size()));
      std::ranges::sort(weights[c]);
      reach(*(weights[c].begin() + end), *(weights[c].end() - 1 - end), kFarther, c);
    }
  }

  void reach(double wanted_low, double wanted_high, double farther, std::size_t channel) {
    double& scale = result_.scale[channel];
    double& offset = result_.offset[channel];
    const double range = 255.0 * scale;
    const double low = std::clamp(wanted_low, offset - farther * range, offset);
    const double high = std::clamp(wanted_high, offset + range, offset + (1.0 + farther) * range);
    if (low == offset && high == offset + range) return;  // not even rounded
    scale = (high - low) / 255.0;
    offset = low;
  }

  /// Writes the codes of one cell, of all expressions or all shapes, the first of which is `first`. Returns how many
  /// are clamped.
  std::size_t encode(const Eigen::MatrixXf& weights, std::size_t cell, std::size_t first) {
    std::size_t clamped = 0;
    for (Eigen::Index n = 0; n < weights.cols(); ++n) {
      std::byte* codes = result_.codes.data() + ((first + static_cast<std::size_t>(n)) * cells() + cell) * channels_;
      for (std::size_t c = 0; c < channels_; ++c) {
        const float solved = weights(static_cast<Eigen::Index>(c), n);
        const double weight = std::isfinite(solved) ? solved : 0.0;  // what overflowed is no weight at all
        const double scale = result_.scale[c];
        const double code = scale > 0.0 ? std::round((weight - result_.offset[c]) / scale) : 0.0;
        codes[c] = static_cast<std::byte>(std::clamp(code, 0.0, 255.0));
        if (!std::isfinite(solved) || code < 0.0 || code > 255.0) ++clamped;
      }
    }
    return clamped;
  }

  Eigen::MatrixXf captured_;  ///< [cell][C] by N
  const PackageWeights& grid_;
  std::size_t channels_;
  const TextureSolver& solver_;
  const SkinFeatures& features_;
  std::vector<raster::TexelSample> samples_;
  std::vector<int> source_;
  Eigen::MatrixXd everywhere_;  ///< of methods that are the same everywhere
  ShapeCodes result_;
};

}  // namespace

Eigen::MatrixXf decodeSet(const Package& package, int set) {
  const PackageDescription& description = package.description();
  const PackageWeights& weights = description.weights[static_cast<std::size_t>(set)];
  const int channels = description.differences;
  const Eigen::Index cells = static_cast<Eigen::Index>(weights.tile_width) * weights.tile_height;
  Eigen::MatrixXf decoded(cells * channels, static_cast<Eigen::Index>(description.expressions.size()));
  package::readWeightAtlas(
      description, set, package.folder(), [&](int n, int row, int first, int count, std::span<const std::byte> codes) {
        for (int x = 0; x < weights.tile_width; ++x) {
          for (int i = 0; i < count; ++i) {
            const auto c = static_cast<std::size_t>(first + i);
            const int code = std::to_integer<int>(codes[static_cast<std::size_t>(x * count + i)]);
            decoded((static_cast<Eigen::Index>(row) * weights.tile_width + x) * channels + first + i, n) =
                static_cast<float>(weights.scale[c] * code + weights.offset[c]);
          }
        }
      });
  return decoded;
}

ShapeCodes solveShapes(const Package& package, int set, const TextureSolver& solver, const SkinFeatures& features,
                       const compress::GridMap& map, Progress& progress) {
  return ShapeSolver(package, set, solver, features, map).run(progress);
}

}  // namespace facezip::rig
