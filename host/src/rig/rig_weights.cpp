#include "rig/rig_weights.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "compress/refine/grid_weights.hpp"
#include "facezip/package.hpp"
#include "io/staged_directory.hpp"
#include "package/package_json.hpp"
#include "package/weight_atlas.hpp"
#include "raster/cell_samples.hpp"
#include "rig/cell_grams.hpp"

namespace facezip::rig {
namespace fs = std::filesystem;
namespace {

/// Cells that leaving out is tried on: errors in so many agree with those in all to a per cent.
constexpr std::size_t kCellsToChooseBy = 2000;
/// As compressed weights have it: the share at either end that may be clamped.
constexpr double kClippedWeights = 2e-4;

/// A set of weights as the package has it, [cell][C] by expression: column n is expression n.
Eigen::MatrixXf decodeSet(const Package& package, int set) {
  const PackageDescription& description = package.description();
  const PackageWeights& weights = description.weights[static_cast<std::size_t>(set)];
  const int channels = description.differences;
  const Eigen::Index cells = static_cast<Eigen::Index>(weights.tile_width) * weights.tile_height;
  Eigen::MatrixXf decoded(cells * channels, static_cast<Eigen::Index>(description.expressions.size()));
  package::readWeightAtlas(
      description, set, package.directory(),
      [&](int n, int row, int first, int count, std::span<const std::byte> codes) {
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

const compress::OpenMap& firstMapOf(const Package& package, const compress::MapSet& maps, int set) {
  for (std::size_t m = 0; m < maps.maps.size(); ++m) {
    if (package.maps()[m].weight_set == set) return maps.maps[m];
  }
  return maps.maps.front();  // Package::open refuses a set that no map uses
}

/// Weights of captured expressions and shapes of one set, as codes.
compress::EncodedWeights solveSet(const Package& package, int set, const TextureSolver& solver,
                                  const SkinFeatures& features, const compress::OpenMap& map, Progress& progress) {
  const Eigen::MatrixXf captured = decodeSet(package, set);
  const PackageWeights& grid = package.weightSets()[static_cast<std::size_t>(set)];
  const int channels = package.differences();
  const auto count = static_cast<int>(captured.cols());
  const auto shapes = static_cast<int>(solver.weights.cols());
  const std::vector<raster::TexelSample> samples = raster::cellSamples(*map.raster, map.weight_scale);
  const std::vector<int> source = raster::nearestSampled(samples, grid.tile_width, grid.tile_height);
  const compress::WeightSpace space{grid.tile_width, grid.tile_height, channels, count + shapes};
  compress::GridWeights weights(space);
  const Eigen::MatrixXd everywhere = solver.method == TextureSolve::kLocal ? Eigen::MatrixXd() : globalSolution(solver);
  // Shapes of one cell: its own captured weights mixed as the nearest sampled cell says.
  const auto mixed = [&](int cell) -> Eigen::MatrixXf {
    const Eigen::MatrixXf own = captured.middleRows(static_cast<Eigen::Index>(cell) * channels, channels);
    const int from = source[static_cast<std::size_t>(cell)];
    if (from < 0) return Eigen::MatrixXf::Zero(channels, shapes);
    if (everywhere.size() > 0) return own * everywhere.transpose().cast<float>();
    const Eigen::MatrixXd solution = localSolution(solver, features.at(samples[static_cast<std::size_t>(from)]));
    return own * solution.transpose().cast<float>();
  };
  progress.stage("textures of shapes", static_cast<std::size_t>(grid.tile_height));
  constexpr int kRows = 8;
  for (int begin = 0; begin < grid.tile_height; begin += kRows) {
    progress.checkCancelled();
    const int end = std::min(begin + kRows, grid.tile_height);
    std::vector<float> rows(static_cast<std::size_t>(end - begin) * space.rowFloats(), 0.0f);
    tbb::parallel_for(0, (end - begin) * grid.tile_width, [&](int i) {
      const int cell = begin * grid.tile_width + i;
      const Eigen::MatrixXf of_shapes = mixed(cell);
      float* out = rows.data() + static_cast<std::size_t>(i) * space.cellFloats();
      for (int c = 0; c < channels; ++c, out += space.lanes()) {
        for (int n = 0; n < count; ++n) out[n] = captured(static_cast<Eigen::Index>(cell) * channels + c, n);
        for (int m = 0; m < shapes; ++m) out[count + m] = of_shapes(c, m);
      }
    });
    weights.store(begin, end, rows);
    progress.advance(static_cast<std::size_t>(end));
  }
  std::vector<std::uint8_t> covered;
  for (const raster::TexelSample& sample : samples) covered.push_back(sample.triangle >= 0 ? 1 : 0);
  return weights.encode(covered, kClippedWeights);
}

}  // namespace

compress::MapSet openPackageMaps(const Capture& capture, const compress::Face& face, const Package& package) {
  compress::MapSet maps = compress::openMaps(capture);
  compress::makeRasters(maps, face.mesh, face.region, 0);
  for (std::size_t m = 0; m < maps.maps.size(); ++m) {
    maps.maps[m].weight_scale = package.maps()[m].weight_scale;
    maps.maps[m].fit_weight = maps.maps[m].metric_weight;
  }
  return maps;
}

ChosenSolve chooseSolve(const RigOptions& options, const Eigen::MatrixXd& weights, const SkinFeatures& features,
                        compress::MapSet& maps, Progress& progress) {
  ChosenSolve chosen;
  chosen.solver = {options.texture_solve, weights, options.texture_damping.value_or(0.3), 0.0};
  if (options.texture_solve != TextureSolve::kLocal) return chosen;
  const compress::OpenMap& map = maps.maps[maps.reference];
  const std::vector<raster::TexelSample> samples = raster::cellSamples(*map.raster, map.weight_scale);
  const int columns = (map.samples->shape().width + map.weight_scale - 1) / map.weight_scale;
  double count = 0.0;
  const std::vector<SolvedCell> cells =
      gatherCells(maps, features, samples, columns, kCellsToChooseBy, count, progress);
  progress.stage("leaving expressions out", 0);
  const LeftOut best = leaveOneOut(chosen.solver, cells, options.texture_damping);
  chosen.solver.damping = best.damping;
  chosen.solver.strain_share = best.strain_share;
  const double values = std::max(count, 1.0) * static_cast<double>(weights.rows());
  chosen.left_out_rmse = std::sqrt(best.error / values);
  chosen.left_out_nothing = std::sqrt(best.nothing / values);
  return chosen;
}

void addShapeWeights(const fs::path& directory, const std::vector<std::string>& captured,
                     const std::vector<std::string>& shapes, const TextureSolver& solver, const SkinFeatures& features,
                     const compress::MapSet& maps, Progress& progress) {
  const Package package = Package::open(directory);
  PackageDescription description = package.description();
  description.expressions = captured;
  description.expressions.insert(description.expressions.end(), shapes.begin(), shapes.end());
  std::vector<compress::EncodedWeights> sets;
  for (int set = 0; set < static_cast<int>(description.weights.size()); ++set) {
    sets.push_back(solveSet(package, set, solver, features, firstMapOf(package, maps, set), progress));
  }
  for (std::size_t set = 0; set < sets.size(); ++set) {
    PackageWeights& weights = description.weights[set];
    weights.scale = sets[set].scale;
    weights.offset = sets[set].offset;
    package::arrangeAtlas(weights, static_cast<int>(description.expressions.size()));
    package::writeWeightAtlas(description, static_cast<int>(set), directory, std::as_bytes(std::span(sets[set].codes)));
  }
  io::writeTextFile(directory / package::kDescriptionFile, package::packageJson(description));
}

}  // namespace facezip::rig
