#include "rig/strain_codes.hpp"

#include <algorithm>
#include <cmath>

#include "compress/compress_stretch.hpp"

namespace facezip::rig {
namespace {

using compress::InfluenceShares;
using compress::kCompressStretchMaps;

/// The captured expressions' shares as the package has them.
InfluenceShares capturedShares(const Package& package, int set) {
  const Eigen::MatrixXf decoded = decodeSet(package, set);
  const Eigen::Index members = decoded.cols();
  InfluenceShares captured{static_cast<int>(members), package.weightSets()[toSize(set)].tile_width, {}};
  captured.shares.resize(toSize(decoded.size()));
  Eigen::Map<Eigen::MatrixXf>(captured.shares.data(), members, decoded.rows()) = decoded.transpose();
  return captured;
}

InfluenceShares shapeShares(const geometry::TriangleMesh& neutral, const geometry::ExampleRig& rig,
                            const compress::GridMap& map) {
  std::vector<Eigen::MatrixX3d> posed;
  for (const Eigen::MatrixX3d& shape : rig.shapes) posed.emplace_back(neutral.positions + shape);
  return compress::normalisedInfluences(neutral, compress::vertexInfluences(neutral, posed), *map.map->raster,
                                        map.weight_scale);
}

}  // namespace

ShapeCodes strainShapes(const Package& package, int set, const geometry::TriangleMesh& neutral,
                        const geometry::ExampleRig& rig, const compress::GridMap& map) {
  const PackageWeights& weights = package.weightSets()[toSize(set)];
  const InfluenceShares shapes = shapeShares(neutral, rig, map);
  std::array<int, kCompressStretchMaps> steps{};
  for (int i = 0; i < kCompressStretchMaps; ++i) {
    steps[toSize(i)] = std::min(static_cast<int>(std::lround(1.0 / weights.scale[toSize(i)])), shapes.steps(i));
  }
  ShapeCodes found{{1.0 / steps[0], 1.0 / steps[1]}, {0.0, 0.0}, {}, 0.0};
  for (const InfluenceShares& shares : {capturedShares(package, set), shapes}) {
    for (const std::uint8_t code : compress::shareCodes(shares, steps)) {
      found.codes.push_back(static_cast<std::byte>(code));
    }
  }
  return found;
}

}  // namespace facezip::rig
