#include "align/slide_field.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/uv_slide.hpp"
#include "flow/flow_sampling.hpp"
#include "io/counts.hpp"
#include "raster/uv_raster.hpp"
#include "register/hole_filling.hpp"

namespace facezip::align {
namespace {

constexpr int kGutter = 4;
constexpr double kBelieved = 0.5;
constexpr int kHalvings = 6;

/// The vector at a place in texels, that of the nearest texels beyond the border.
Eigen::RowVector2d vectorAt(const SlideField& field, double x, double y) {
  const flow::Bilinear at(std::clamp(x, 0.0, field.width - 1.0 - 1e-6), std::clamp(y, 0.0, field.height - 1.0 - 1e-6),
                          field.width, field.height);
  return at.mean([&](int i, int j) {
    const float* vector = &field.vectors[2 * (toSize(j) * toSize(field.width) + toSize(i))];
    return Eigen::RowVector2d(double{vector[0]}, double{vector[1]});
  });
}

/// Shortens vectors until they end on the island that they begin on.
void keepInIslands(SlideField& field, const std::vector<int>& islands) {
  tbb::parallel_for(0, field.height, [&](int y) {
    for (int x = 0; x < field.width; ++x) {
      const std::size_t at = toSize(y) * toSize(field.width) + toSize(x);
      float* vector = &field.vectors[2 * at];
      if (islands[at] < 0) continue;
      const auto leaves = [&] {
        const int i = x + static_cast<int>(std::lround(vector[0])), j = y + static_cast<int>(std::lround(vector[1]));
        if (i < 0 || j < 0 || i >= field.width || j >= field.height) return true;
        return islands[toSize(j) * toSize(field.width) + toSize(i)] != islands[at];
      };
      for (int halving = 0; leaves(); ++halving) {
        const float share = halving < kHalvings ? 0.5f : 0.0f;
        vector[0] *= share;
        vector[1] *= share;
      }
    }
  });
}

}  // namespace

Eigen::RowVector2d SlideField::at(double u, double v) const {
  return vectorAt(*this, u * width - 0.5, (1.0 - v) * height - 0.5);
}

SlideField stillField(int width, int height) {
  return {width, height, std::vector<float>(2 * toSize(width) * toSize(height), 0.0f)};
}

LayoutTexels texelsOf(const geometry::TriangleMesh& mesh, std::span<const int> region, int width, int height) {
  const std::vector<int> islands = geometry::uvIslands(mesh);
  const std::vector<int> whole = geometry::wholeMeshRegion(mesh);
  const auto all = raster::UvRaster(mesh, whole, width, height, kGutter).rows(0, height);
  const auto inner = raster::UvRaster(mesh, region, width, height, 0).rows(0, height);
  LayoutTexels texels;
  for (std::size_t i = 0; i < all.size(); ++i) {
    texels.island.push_back(all[i].triangle < 0 ? -1 : islands[toSize(all[i].triangle)]);
    texels.region.push_back(inner[i].kind == raster::TexelSample::Kind::kCovered ? 1 : 0);
    texels.elsewhere.push_back(inner[i].kind == raster::TexelSample::Kind::kOutside ? 1 : 0);
  }
  return texels;
}

SlideField composed(const SlideField& field, const flow::TextureFlow& flow, const LayoutTexels& texels) {
  std::vector<float> filled(flow.forward.size(), 0.0f);
  std::vector<std::uint8_t> known = texels.elsewhere;  // at rest
  tbb::parallel_for(0, field.height, [&](int y) {
    for (int x = 0; x < field.width; ++x) {
      const std::size_t at = toSize(y) * toSize(field.width) + toSize(x);
      if (texels.region[at] == 0 || flow::trustOf(flow, x, y) < kBelieved) continue;
      filled[2 * at] = flow.forward[2 * at];
      filled[2 * at + 1] = flow.forward[2 * at + 1];
      known[at] = 1;
    }
  });
  registration::fillHoles(filled, 2, field.width, field.height, known);
  SlideField result = stillField(field.width, field.height);
  tbb::parallel_for(0, field.height, [&](int y) {
    for (int x = 0; x < field.width; ++x) {
      const std::size_t at = toSize(y) * toSize(field.width) + toSize(x);
      const double dx = double{filled[2 * at]}, dy = double{filled[2 * at + 1]};
      const Eigen::RowVector2d before = vectorAt(field, x + dx, y + dy);
      result.vectors[2 * at] = static_cast<float>(dx + before.x());
      result.vectors[2 * at + 1] = static_cast<float>(dy + before.y());
    }
  });
  keepInIslands(result, texels.island);
  return result;
}

std::vector<float> placesOf(const SlideField& field, int begin, int end, int width, int height) {
  std::vector<float> places(2 * toSize(end - begin) * toSize(width));
  const double columns = static_cast<double>(width) / field.width, rows = static_cast<double>(height) / field.height;
  tbb::parallel_for(begin, end, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const Eigen::RowVector2d vector = vectorAt(field, (x + 0.5) / columns - 0.5, (y + 0.5) / rows - 0.5);
      float* place = &places[2 * (toSize(y - begin) * toSize(width) + toSize(x))];
      place[0] = static_cast<float>(x + columns * vector.x());
      place[1] = static_cast<float>(y + rows * vector.y());
    }
  });
  return places;
}

}  // namespace facezip::align
