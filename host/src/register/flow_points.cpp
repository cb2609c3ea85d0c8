#include "register/flow_points.hpp"

#include <algorithm>
#include <cmath>

#include "flow/flow_sampling.hpp"
#include "io/counts.hpp"

namespace facezip::registration {
namespace {

constexpr double kApart = 6.0;          // texels, between the places of two texels that touch at a corner
constexpr double kLeastBelieved = 0.2;  // of a triangle's texels

/// Sums over the texels of a triangle.
struct Gathered {
  double texels = 0.0;
  double trust = 0.0;
  Eigen::RowVector3d barycentric = Eigen::RowVector3d::Zero();
  Eigen::RowVector3d target = Eigen::RowVector3d::Zero();
};

}  // namespace

std::vector<geometry::SkinPoint> flowPoints(const flow::TextureFlow& flow, std::span<const raster::TexelSample> texels,
                                            std::span<const std::uint8_t> known, const TexelPlaces& places,
                                            int triangles, double texel) {
  std::vector<Gathered> gathered(toSize(triangles));
  const auto placeOf = [&](int i, int j) { return places.row(Eigen::Index{j} * flow.width + i); };
  for (int y = 0; y < flow.height; ++y) {
    for (int x = 0; x < flow.width; ++x) {
      const std::size_t at = toSize(y) * toSize(flow.width) + toSize(x);
      if (texels[at].triangle < 0) continue;
      Gathered& sums = gathered[toSize(texels[at].triangle)];
      sums.texels += 1.0;
      if (known[at] == 0) continue;
      const float* vector = &flow.forward[flow::texelAt(flow, x, y)];
      const flow::Bilinear end(x + vector[0], y + vector[1], flow.width, flow.height);
      if (!end.inside) continue;
      const double apart = std::max((placeOf(end.column, end.row) - placeOf(end.column + 1, end.row + 1)).norm(),
                                    (placeOf(end.column + 1, end.row) - placeOf(end.column, end.row + 1)).norm());
      const Eigen::RowVector3d target = end.mean([&](int i, int j) { return Eigen::RowVector3d(placeOf(i, j)); });
      if (!(apart <= kApart * texel) || !target.allFinite()) continue;
      const double trust = flow::trustOf(flow, x, y);
      const double b0 = double{texels[at].b0}, b1 = double{texels[at].b1};
      sums.trust += trust;
      sums.barycentric += trust * Eigen::RowVector3d(b0, b1, 1.0 - b0 - b1);
      sums.target += trust * target;
    }
  }
  std::vector<geometry::SkinPoint> points;
  for (int t = 0; t < triangles; ++t) {
    const Gathered& sums = gathered[toSize(t)];
    if (!(sums.trust > 0.0) || sums.trust < kLeastBelieved * sums.texels) continue;
    points.push_back({t, sums.barycentric / sums.trust, sums.target / sums.trust, sums.trust / sums.texels});
  }
  return points;
}

}  // namespace facezip::registration
