#include "facezip/geometry/scan_surface.hpp"

#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <cstdint>

#include "facezip/error.hpp"
#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/mesh_edges.hpp"

namespace facezip::geometry {
namespace {

constexpr double kSmallPart = 0.01;  // of the largest part's area
constexpr float kTrusted = 0.5f;     // triangles below make no points

int weldVertices(TriangleMesh& scan) {
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(scan.positions.rows()));
  for (const auto& p : scan.positions.rowwise()) points.emplace_back(p[0], p[1], p[2]);
  std::vector<std::array<std::size_t, 3>> triangles(static_cast<std::size_t>(scan.triangles.rows()));
  for (Eigen::Index t = 0; t < scan.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)] =
          static_cast<std::size_t>(scan.triangles(t, k));
    }
  }
  const std::size_t welded = CGAL::Polygon_mesh_processing::merge_duplicate_points_in_polygon_soup(points, triangles);
  if (welded == 0) return 0;
  scan.positions.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v) {
    scan.positions.row(static_cast<Eigen::Index>(v)) << points[v].x(), points[v].y(), points[v].z();
  }
  for (Eigen::Index t = 0; t < scan.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      scan.triangles(t, k) = static_cast<int>(triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)]);
    }
  }
  return static_cast<int>(welded);
}

/// The connected part of every triangle, as a vertex that stands for it.
std::vector<int> partsOf(const TriangleMesh& scan) {
  const auto vertices = static_cast<std::size_t>(scan.positions.rows());
  std::vector<int> rank(vertices), parent(vertices);
  boost::disjoint_sets<int*, int*> sets(rank.data(), parent.data());
  for (std::size_t v = 0; v < vertices; ++v) sets.make_set(static_cast<int>(v));
  for (const auto& triangle : scan.triangles.rowwise()) {
    sets.union_set(triangle[0], triangle[1]);
    sets.union_set(triangle[0], triangle[2]);
  }
  std::vector<int> parts;
  for (const auto& triangle : scan.triangles.rowwise()) parts.push_back(sets.find_set(triangle[0]));
  return parts;
}

void keepTriangles(TriangleMesh& scan, const std::vector<int>& kept) {
  scan.triangles = scan.triangles(kept, Eigen::all).eval();
  if (scan.uv_triangles.rows() > 0) scan.uv_triangles = scan.uv_triangles(kept, Eigen::all).eval();
  if (scan.polygons.empty()) return;
  std::vector<int> polygons;
  for (const int triangle : kept) polygons.push_back(scan.polygons[static_cast<std::size_t>(triangle)]);
  scan.polygons = std::move(polygons);
}

int crowdedEdges(const Eigen::MatrixX3i& triangles) {
  std::vector<std::array<int, 2>> edges;
  for (const auto& triangle : triangles.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({triangle[k], triangle[(k + 1) % 3]});
      edges.push_back({low, high});
    }
  }
  std::sort(edges.begin(), edges.end());
  int crowded = 0;
  for (std::size_t i = 2; i < edges.size(); ++i) {
    if (edges[i] == edges[i - 2] && (i == 2 || edges[i] != edges[i - 3])) ++crowded;
  }
  return crowded;
}

/// Whether a vertex is among the thinned points: by a hash, since neighbours in the file are neighbours on the skin.
bool isChosen(std::uint32_t vertex, double share) {
  std::uint32_t h = vertex * 0x9e3779b9u;
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h ^= h >> 13;
  return h < share * 4294967296.0;
}

ScanPoints pointsOf(const TrustedScan& judged, const Eigen::MatrixX3i& triangles, int most_points) {
  const Eigen::MatrixX3d normals = vertexNormals(judged.positions, triangles);
  Eigen::VectorXd areas = vertexAreas(judged.positions, triangles);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (judged.trust[static_cast<std::size_t>(t)] >= kTrusted) continue;
    for (int k = 0; k < 3; ++k) areas[triangles(t, k)] = 0.0;
  }
  const double share = std::min(1.0, most_points / static_cast<double>(std::max<Eigen::Index>(1, areas.size())));
  std::vector<int> chosen;
  for (Eigen::Index v = 0; v < areas.size(); ++v) {
    if (areas[v] > 0.0 && (share >= 1.0 || isChosen(static_cast<std::uint32_t>(v), share))) {
      chosen.push_back(static_cast<int>(v));
    }
  }
  return {judged.positions(chosen, Eigen::all), normals(chosen, Eigen::all), areas(chosen) / share};
}

}  // namespace

ScanCleaning cleanScan(TriangleMesh& scan, std::vector<int>* kept_rows) {
  ScanCleaning cleaning;
  cleaning.welded_vertices = weldVertices(scan);
  const std::vector<int> parts = partsOf(scan);
  std::vector<double> part_areas(static_cast<std::size_t>(scan.positions.rows()), 0.0);
  std::vector<double> areas(parts.size());
  for (std::size_t t = 0; t < parts.size(); ++t) {
    areas[t] = triangleArea(scan.positions, scan.triangles, static_cast<Eigen::Index>(t));
    part_areas[static_cast<std::size_t>(parts[t])] += areas[t];
  }
  const double largest = part_areas.empty() ? 0.0 : *std::max_element(part_areas.begin(), part_areas.end());
  std::vector<int> kept;
  for (std::size_t t = 0; t < parts.size(); ++t) {
    if (part_areas[static_cast<std::size_t>(parts[t])] < kSmallPart * largest) {
      ++cleaning.loose_triangles;
    } else if (!(areas[t] > 0.0)) {
      ++cleaning.flat_triangles;
    } else {
      kept.push_back(static_cast<int>(t));
    }
  }
  if (kept.empty()) throw InputError({"", "", "a mesh with area", "triangles without any", ""});
  keepTriangles(scan, kept);
  cleaning.crowded_edges = crowdedEdges(scan.triangles);
  if (kept_rows != nullptr) *kept_rows = std::move(kept);
  return cleaning;
}

ScanSurface::ScanSurface(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, int most_points)
    : judged_(judgeScan(positions, triangles)),
      surface_(judged_.positions, triangles),
      points_(pointsOf(judged_, triangles, most_points)),
      diagonal_(boundingDiagonal(judged_.positions)) {}

}  // namespace facezip::geometry
