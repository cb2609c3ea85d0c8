#include "raster/uv_raster.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "io/counts.hpp"
#include "raster/gutter.hpp"

namespace facezip::raster {
namespace {

/// Slack for texel centres that lie on an edge up to rounding: a crack one texel wide would be a hole in every mask.
constexpr double kEdgeSlack = 1e-9;

}  // namespace

UvRaster::UvRaster(const geometry::TriangleMesh& mesh, std::span<const int> region, int width, int height, int gutter,
                   int feather)
    : width_(width), height_(height), gutter_(gutter), feather_(feather) {
  assert(mesh.uv_triangles.rows() == mesh.triangles.rows());
  std::vector<bool> in_region(toSize(mesh.triangles.rows()), false);
  for (const int triangle : region) in_region[toSize(triangle)] = true;
  for (Eigen::Index t = 0; t < mesh.uv_triangles.rows(); ++t) {
    UvTriangle out{};
    for (int corner = 0; corner < 3; ++corner) {
      const Eigen::RowVector2d uv = mesh.uvs.row(mesh.uv_triangles(t, corner));
      out.x[corner] = uv.x() * width - 0.5;
      out.y[corner] = (1.0 - uv.y()) * height - 0.5;
    }
    const double area2 = (out.x[1] - out.x[0]) * (out.y[2] - out.y[0]) - (out.x[2] - out.x[0]) * (out.y[1] - out.y[0]);
    if (area2 == 0.0) continue;  // covers no texel
    out.inverse_area2 = 1.0 / area2;
    out.index = static_cast<std::int32_t>(t);
    out.in_region = in_region[toSize(t)];
    triangles_.push_back(out);
  }
  const auto firstRow = [](const UvTriangle& t) {
    return static_cast<int>(std::ceil(std::min({t.y[0], t.y[1], t.y[2]}) - kEdgeSlack));
  };
  std::stable_sort(triangles_.begin(), triangles_.end(),
                   [&](const UvTriangle& a, const UvTriangle& b) { return firstRow(a) < firstRow(b); });
  for (const UvTriangle& t : triangles_) {
    first_row_.push_back(firstRow(t));
    tallest_ = std::max(tallest_, static_cast<int>(std::max({t.y[0], t.y[1], t.y[2]})) - first_row_.back() + 2);
  }
}

void UvRaster::fillTriangle(const UvTriangle& t, int begin, int end, int first, std::span<TexelSample> samples) const {
  const int y_begin = std::max(begin, static_cast<int>(std::ceil(std::min({t.y[0], t.y[1], t.y[2]}) - kEdgeSlack)));
  const int y_end = std::min(end, static_cast<int>(std::floor(std::max({t.y[0], t.y[1], t.y[2]}) + kEdgeSlack)) + 1);
  const int x_begin = std::max(0, static_cast<int>(std::ceil(std::min({t.x[0], t.x[1], t.x[2]}) - kEdgeSlack)));
  const int x_end = std::min(width_, static_cast<int>(std::floor(std::max({t.x[0], t.x[1], t.x[2]}) + kEdgeSlack)) + 1);
  for (int y = y_begin; y < y_end; ++y) {
    TexelSample* row = samples.data() + toSize(y - first, width_);
    for (int x = x_begin; x < x_end; ++x) {
      const double b1 = ((x - t.x[0]) * (t.y[2] - t.y[0]) - (t.x[2] - t.x[0]) * (y - t.y[0])) * t.inverse_area2;
      const double b2 = ((t.x[1] - t.x[0]) * (y - t.y[0]) - (x - t.x[0]) * (t.y[1] - t.y[0])) * t.inverse_area2;
      const double b0 = 1.0 - b1 - b2;
      if (b0 < -kEdgeSlack || b1 < -kEdgeSlack || b2 < -kEdgeSlack) continue;
      TexelSample& sample = row[x];
      // Triangles of the region win over others on a shared edge; among equals the lowest index.
      const bool taken = sample.kind == TexelSample::Kind::kCovered && (!t.in_region || sample.triangle < t.index);
      if (taken) continue;
      if (t.in_region) {
        sample = {t.index, static_cast<float>(std::clamp(b0, 0.0, 1.0)), static_cast<float>(std::clamp(b1, 0.0, 1.0)),
                  TexelSample::Kind::kCovered};
      } else {
        sample.kind = TexelSample::Kind::kOutside;
      }
    }
  }
}

std::vector<TexelSample> UvRaster::coveredRows(int begin, int end) const {
  std::vector<TexelSample> samples(toSize(end - begin, width_));
  constexpr int kRowsAtOnce = 32;
  tbb::parallel_for(tbb::blocked_range<int>(begin, end, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
    const auto first = std::lower_bound(first_row_.begin(), first_row_.end(), rows.begin() - tallest_);
    const auto last = std::lower_bound(first_row_.begin(), first_row_.end(), rows.end());
    for (auto it = first; it < last; ++it) {
      fillTriangle(triangles_[toSize(it - first_row_.begin())], rows.begin(), rows.end(), begin, samples);
    }
  });
  return samples;
}

std::vector<TexelSample> UvRaster::rows(int begin, int end) const {
  assert(0 <= begin && begin <= end && end <= height_);
  // Gutter and feather of a band reach for covered texels in the rows above and below it.
  const int covered_begin = std::max(0, begin - reach());
  const int covered_end = std::min(height_, end + reach());
  const std::vector<TexelSample> covered = coveredRows(covered_begin, covered_end);
  const auto offset = [&](int row) { return static_cast<std::ptrdiff_t>(row - covered_begin) * width_; };
  std::vector<TexelSample> samples(covered.begin() + offset(begin), covered.begin() + offset(end));
  fillGutter(covered, width_, covered_begin, covered_end, begin, end, {gutter_, feather_}, samples);
  return samples;
}

}  // namespace facezip::raster
