#include "facezip/geometry/mesh_edges.hpp"

#include <tbb/parallel_sort.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace facezip::geometry {
namespace {

/// An edge as a triangle has it: its vertices in order, and 4 t + k for the edge opposite corner k of triangle t.
struct SidedEdge {
  std::array<int, 2> vertices;
  std::int64_t side;
};

std::vector<SidedEdge> sidedEdges(const Eigen::MatrixX3i& triangles, const std::vector<bool>& used) {
  std::vector<SidedEdge> edges;
  edges.reserve(3 * static_cast<std::size_t>(triangles.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (!used.empty() && !used[static_cast<std::size_t>(t)]) continue;
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({triangles(t, (k + 1) % 3), triangles(t, (k + 2) % 3)});
      edges.push_back({{low, high}, 4 * t + k});
    }
  }
  tbb::parallel_sort(edges.begin(), edges.end(), [](const SidedEdge& a, const SidedEdge& b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.side < b.side;
  });
  return edges;
}

Eigen::RowVector3d areaNormal(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, Eigen::Index t) {
  const Eigen::RowVector3d a = positions.row(triangles(t, 0));
  const Eigen::RowVector3d ab = positions.row(triangles(t, 1)) - a;
  const Eigen::RowVector3d ac = positions.row(triangles(t, 2)) - a;
  return 0.5 * ab.cross(ac);
}

}  // namespace

Eigen::MatrixX3d triangleNormals(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles) {
  Eigen::MatrixX3d normals(triangles.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d normal = areaNormal(positions, triangles, t);
    const double length = normal.norm();
    normals.row(t) = length > 0.0 ? Eigen::RowVector3d(normal / length) : Eigen::RowVector3d::Zero();
  }
  return normals;
}

Eigen::MatrixX3d vertexNormals(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles) {
  Eigen::MatrixX3d normals = Eigen::MatrixX3d::Zero(positions.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d normal = areaNormal(positions, triangles, t);
    for (int k = 0; k < 3; ++k) normals.row(triangles(t, k)) += normal;
  }
  for (Eigen::Index v = 0; v < normals.rows(); ++v) {
    const double length = normals.row(v).norm();
    if (length > 0.0) normals.row(v) /= length;
  }
  return normals;
}

std::vector<unsigned char> borderEdges(const Eigen::MatrixX3i& triangles, const std::vector<bool>& used) {
  const std::vector<SidedEdge> edges = sidedEdges(triangles, used);
  std::vector<unsigned char> borders(static_cast<std::size_t>(triangles.rows()), 0);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool shared = (i > 0 && edges[i - 1].vertices == edges[i].vertices) ||
                        (i + 1 < edges.size() && edges[i + 1].vertices == edges[i].vertices);
    if (shared) continue;
    borders[static_cast<std::size_t>(edges[i].side / 4)] |= static_cast<unsigned char>(1 << (edges[i].side % 4));
  }
  return borders;
}

std::vector<std::array<int, 2>> meshEdges(const Eigen::MatrixX3i& triangles) {
  std::vector<std::array<int, 2>> found;
  for (const SidedEdge& edge : sidedEdges(triangles, {})) {
    const bool known = !found.empty() && found.back() == edge.vertices;
    if (!known && edge.vertices[0] != edge.vertices[1]) found.push_back(edge.vertices);
  }
  return found;
}

double triangleArea(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, Eigen::Index t) {
  return areaNormal(positions, triangles, t).norm();
}

Eigen::VectorXd vertexAreas(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(positions.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const double third = triangleArea(positions, triangles, t) / 3.0;
    for (int k = 0; k < 3; ++k) areas[triangles(t, k)] += third;
  }
  return areas;
}

}  // namespace facezip::geometry
