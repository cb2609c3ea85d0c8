#include "synth/chart_raster.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace facezip::synth {
namespace {

constexpr int kRowsPerBucket = 8;

/// Where the edge between two corners crosses height v. Both triangles of an edge must find the same bits, or a texel
/// falls between them: the corners are put in one order first.
double crossing(Eigen::Vector2d a, Eigen::Vector2d b, double v) {
  if (std::pair(b.y(), b.x()) < std::pair(a.y(), a.x())) std::swap(a, b);
  return a.x() + (v - a.y()) * (b.x() - a.x()) / (b.y() - a.y());
}

/// Nearest point of a segment, as the share of the way from a to b, and its squared distance.
std::pair<double, double> nearestOnSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& a,
                                           const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double share = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return {share, (a + share * along - point).squaredNorm()};
}

}  // namespace

ChartRaster::ChartRaster(const geometry::TriangleMesh& mesh, int resolution) : mesh_(mesh), resolution_(resolution) {
  triangles_of_row_.resize(static_cast<std::size_t>(resolution / kRowsPerBucket + 1));
  for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
    double low = 1.0, high = 0.0;
    for (int k = 0; k < 3; ++k) {
      low = std::min(low, corner(f, k).y());
      high = std::max(high, corner(f, k).y());
    }
    const int first = std::max(0, static_cast<int>((1.0 - high) * resolution) - 1) / kRowsPerBucket;
    const int last = std::min(resolution - 1, static_cast<int>((1.0 - low) * resolution) + 1) / kRowsPerBucket;
    for (int bucket = first; bucket <= last; ++bucket) triangles_of_row_[static_cast<std::size_t>(bucket)].push_back(f);
  }
  collectBorder();
  binBorder();
}

Eigen::Vector2d ChartRaster::corner(std::int32_t triangle, int k) const {
  return mesh_.uvs.row(mesh_.uv_triangles(triangle, k)).transpose();
}

void ChartRaster::collectBorder() {
  // An edge of the border has no twin that runs the other way.
  std::map<std::pair<int, int>, std::pair<std::int32_t, int>> edges;
  for (std::int32_t f = 0; f < mesh_.triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int from = mesh_.triangles(f, k);
      const int to = mesh_.triangles(f, (k + 1) % 3);
      if (edges.erase({to, from}) == 0) edges[{from, to}] = {f, k};
    }
  }
  for (const auto& [ends, place] : edges) {
    border_.push_back(
        {place.first, place.second, corner(place.first, place.second), corner(place.first, (place.second + 1) % 3)});
  }
}

void ChartRaster::binBorder() {
  // An edge can be the nearest of some point in a bin only if it is at most a bin's diameter farther from the bin's
  // centre than the nearest edge is.
  const double diameter = std::sqrt(2.0) / kBins;
  border_of_bin_.resize(kBins * kBins);
  std::vector<double> distances(border_.size());
  for (int bin = 0; bin < kBins * kBins; ++bin) {
    const Eigen::Vector2d centre((bin % kBins + 0.5) / kBins, (bin / kBins + 0.5) / kBins);
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t e = 0; e < border_.size(); ++e) {
      distances[e] = std::sqrt(nearestOnSegment(centre, border_[e].from, border_[e].to).second);
      nearest = std::min(nearest, distances[e]);
    }
    for (std::size_t e = 0; e < border_.size(); ++e) {
      if (distances[e] <= nearest + diameter)
        border_of_bin_[static_cast<std::size_t>(bin)].push_back(static_cast<std::int32_t>(e));
    }
  }
}

void ChartRaster::rasteriseRow(int row, std::span<MeshPoint> points) const {
  std::fill(points.begin(), points.end(), MeshPoint{});
  fillCovered(row, points);
  const double v = 1.0 - (row + 0.5) / resolution_;
  for (std::size_t x = 0; x < points.size(); ++x) {
    if (points[x].triangle < 0) points[x] = nearestOnBorder({(static_cast<double>(x) + 0.5) / resolution_, v});
  }
}

void ChartRaster::fillCovered(int row, std::span<MeshPoint> points) const {
  const double v = 1.0 - (row + 0.5) / resolution_;
  for (const std::int32_t f : triangles_of_row_[static_cast<std::size_t>(row / kRowsPerBucket)]) {
    const std::array<Eigen::Vector2d, 3> p = {corner(f, 0), corner(f, 1), corner(f, 2)};
    // The row enters and leaves a triangle through the two edges whose ends lie on different sides of it.
    std::array<double, 2> ends{};
    int crossings = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2d& a = p[k];
      const Eigen::Vector2d& b = p[(k + 1) % 3];
      if ((a.y() <= v) != (b.y() <= v) && crossings < 2)
        ends[static_cast<std::size_t>(crossings++)] = crossing(a, b, v);
    }
    if (crossings < 2) continue;
    const auto [left, right] = std::minmax(ends[0], ends[1]);
    const int first = std::max(0, static_cast<int>(std::ceil(left * resolution_ - 0.5)));
    const int last = std::min(resolution_, static_cast<int>(std::ceil(right * resolution_ - 0.5)));
    Eigen::Matrix2d edges;
    edges << p[1] - p[0], p[2] - p[0];
    const Eigen::Matrix2d inverse = edges.inverse();
    for (int x = first; x < last; ++x) {
      const Eigen::Vector2d weights = inverse * (Eigen::Vector2d((x + 0.5) / resolution_, v) - p[0]);
      points[static_cast<std::size_t>(x)] = {f, static_cast<float>(weights.x()), static_cast<float>(weights.y())};
    }
  }
}

MeshPoint ChartRaster::nearestOnBorder(const Eigen::Vector2d& uv) const {
  const int bin_x = std::clamp(static_cast<int>(uv.x() * kBins), 0, kBins - 1);
  const int bin_y = std::clamp(static_cast<int>(uv.y() * kBins), 0, kBins - 1);
  double best = std::numeric_limits<double>::max();
  MeshPoint point;
  for (const std::int32_t e : border_of_bin_[static_cast<std::size_t>(bin_y * kBins + bin_x)]) {
    const BorderEdge& edge = border_[static_cast<std::size_t>(e)];
    const auto [share, squared] = nearestOnSegment(uv, edge.from, edge.to);
    if (squared >= best) continue;
    best = squared;
    std::array<float, 3> weights{};
    weights[static_cast<std::size_t>(edge.corner)] = static_cast<float>(1.0 - share);
    weights[static_cast<std::size_t>((edge.corner + 1) % 3)] = static_cast<float>(share);
    point = {edge.triangle, weights[1], weights[2]};
  }
  return point;
}

}  // namespace facezip::synth
