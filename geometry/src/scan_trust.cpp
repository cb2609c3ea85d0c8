#include "facezip/geometry/scan_trust.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "facezip/geometry/mesh_edges.hpp"

namespace facezip::geometry {
namespace {

constexpr double kSpikeRoughness = 6.0;  // deviations beyond which noise has no part in it ...
constexpr double kSpikeEdge = 0.3;       // ... and of the mean edge around: creases deviate, too
constexpr double kLongEdge = 4.0;        // of the scan's median edge
constexpr double kDeviation = 1.4826;    // standard deviation of a normal distribution over its median deviation

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Neighbours of every vertex, one after the other.
struct Neighbours {
  std::vector<int> begin;
  std::vector<int> vertices;

  Neighbours(const std::vector<std::array<int, 2>>& edges, Eigen::Index count)
      : begin(static_cast<std::size_t>(count) + 1, 0), vertices(2 * edges.size()) {
    for (const auto& edge : edges) {
      for (const int v : edge) ++begin[static_cast<std::size_t>(v) + 1];
    }
    for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
    std::vector<int> next(begin.begin(), begin.end() - 1);
    for (const auto& [a, b] : edges) {
      vertices[static_cast<std::size_t>(next[static_cast<std::size_t>(a)]++)] = b;
      vertices[static_cast<std::size_t>(next[static_cast<std::size_t>(b)]++)] = a;
    }
  }
};

}  // namespace

TrustedScan judgeScan(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles) {
  const std::vector<std::array<int, 2>> edges = meshEdges(triangles);
  const Neighbours neighbours(edges, positions.rows());
  const Eigen::MatrixX3d normals = vertexNormals(positions, triangles);
  std::vector<double> lengths(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    lengths[e] = (positions.row(edges[e][0]) - positions.row(edges[e][1])).norm();
  }
  const double median_edge = medianOf(lengths);

  // The median height of the neighbours, not their mean: one spike would make spikes of all vertices around it.
  const auto count = static_cast<std::size_t>(positions.rows());
  std::vector<double> heights(count, 0.0), reach(count, 0.0);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    std::vector<double> around;
    for (int i = neighbours.begin[v]; i < neighbours.begin[v + 1]; ++i) {
      const Eigen::RowVector3d edge =
          positions.row(neighbours.vertices[static_cast<std::size_t>(i)]) - positions.row(row);
      around.push_back(edge.dot(normals.row(row)));
      reach[v] += edge.norm();
    }
    if (around.size() < 3) return;  // a corner of the border says nothing
    reach[v] /= static_cast<double>(around.size());
    heights[v] = medianOf(std::move(around));
  });
  std::vector<double> sizes(count);
  std::transform(heights.begin(), heights.end(), sizes.begin(), [](double h) { return std::abs(h); });
  TrustedScan scan;
  scan.roughness = kDeviation * medianOf(sizes);
  scan.positions = positions;
  for (std::size_t v = 0; v < count; ++v) {
    if (!(sizes[v] > std::max(kSpikeRoughness * scan.roughness, kSpikeEdge * reach[v])) || reach[v] == 0.0) continue;
    scan.positions.row(static_cast<Eigen::Index>(v)) += heights[v] * normals.row(static_cast<Eigen::Index>(v));
    ++scan.spikes;
  }
  scan.trust.assign(static_cast<std::size_t>(triangles.rows()), 1.0f);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest,
                         (scan.positions.row(triangles(t, k)) - scan.positions.row(triangles(t, (k + 1) % 3))).norm());
    }
    if (longest > kLongEdge * median_edge) scan.trust[static_cast<std::size_t>(t)] = 0.0f;
  }
  return scan;
}

}  // namespace facezip::geometry
