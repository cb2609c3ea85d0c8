#include "rig/rig_weights.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "facezip/package.hpp"
#include "io/staged_directory.hpp"
#include "package/package_json.hpp"
#include "package/weight_atlas.hpp"
#include "raster/cell_samples.hpp"
#include "rig/cell_grams.hpp"
#include "rig/shape_codes.hpp"

namespace facezip::rig {
namespace fs = std::filesystem;
namespace {

/// Cells that leaving out is tried on: errors in so many agree with those in all to a per cent.
constexpr std::size_t kCellsToChooseBy = 2000;

const compress::GridMap& firstMapOf(const Package& package, const PackageMaps& maps, int set) {
  for (const compress::GridMap& map : maps.maps) {
    if (package.maps()[map.index].weight_set == set) return map;
  }
  return maps.maps.front();  // Package::open refuses a set that no map uses
}

}  // namespace

PackageMaps openPackageMaps(const Capture& capture, const compress::Face& face, const Package& package) {
  PackageMaps maps{compress::openMaps(capture), {}};
  compress::makeRasters(maps.set, face.mesh, face.region, {.gutter = 0});
  for (std::size_t m = 0; m < maps.set.maps.size(); ++m) {
    compress::OpenMap& map = maps.set.maps[m];
    maps.maps.push_back({&map, m, map.metric_weight, package.maps()[m].weight_scale});
  }
  return maps;
}

ChosenSolve chooseSolve(const RigOptions& options, const Eigen::MatrixXd& weights, const SkinFeatures& features,
                        const PackageMaps& maps, Progress& progress) {
  ChosenSolve chosen;
  chosen.solver = {textureSolveOf(options), weights, options.texture_damping.value_or(0.3), 0.0};
  if (chosen.solver.method != TextureSolve::kLocal) return chosen;
  const compress::GridMap& map = maps.reference();
  const std::vector<raster::TexelSample> samples = raster::cellSamples(*map.map->raster, map.weight_scale);
  const int columns = (map.map->samples->shape().width + map.weight_scale - 1) / map.weight_scale;
  double count = 0.0;
  const std::vector<SolvedCell> cells =
      gatherCells(maps.maps, features, samples, columns, kCellsToChooseBy, count, progress);
  progress.stage("leaving expressions out", 0);
  const LeftOut best = leaveOneOut(chosen.solver, cells, options.texture_damping);
  chosen.solver.damping = best.damping;
  chosen.solver.strain_share = best.strain_share;
  const double values = std::max(count, 1.0) * static_cast<double>(weights.rows());
  chosen.left_out_rmse = std::sqrt(best.error / values);
  chosen.left_out_nothing = std::sqrt(best.nothing / values);
  return chosen;
}

double addShapeWeights(const fs::path& directory, const std::vector<std::string>& captured,
                       const std::vector<std::string>& shapes, const SolveSet& solve, const PackageMaps& maps) {
  const Package package = Package::open(directory);
  PackageDescription description = package.description();
  description.expressions = captured;
  description.expressions.insert(description.expressions.end(), shapes.begin(), shapes.end());
  std::vector<ShapeCodes> sets;
  for (int set = 0; set < static_cast<int>(description.weights.size()); ++set) {
    sets.push_back(solve(package, set, firstMapOf(package, maps, set)));
  }
  double clamped = 0.0;
  for (std::size_t set = 0; set < sets.size(); ++set) {
    PackageWeights& weights = description.weights[set];
    weights.scale = sets[set].scale;
    weights.offset = sets[set].offset;
    package::arrangeAtlas(weights, static_cast<int>(description.expressions.size()));
    package::writeWeightAtlas(description, static_cast<int>(set), directory, sets[set].codes);
    clamped = std::max(clamped, sets[set].clamped);
  }
  io::writeTextFile(directory / package::kDescriptionFile, package::packageJson(description));
  return clamped;
}

}  // namespace facezip::rig
