#include "facezip/geometry/uv_slide.hpp"

#include <boost/pending/disjoint_sets.hpp>
#include <cassert>

#include "facezip/geometry/closest_surface.hpp"

namespace facezip::geometry {
namespace {

constexpr double kInside = 1e-6;  // of the layout: a point of an edge may miss it by rounding
constexpr int kHalvings = 5;

}  // namespace

std::vector<int> uvIslands(const TriangleMesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.uvs.rows());
  std::vector<int> rank(count), parent(count), number(count, -1);
  boost::disjoint_sets<int*, int*> sets(rank.data(), parent.data());
  for (std::size_t v = 0; v < count; ++v) sets.make_set(static_cast<int>(v));
  for (const auto& triangle : mesh.uv_triangles.rowwise()) {
    sets.union_set(triangle[0], triangle[1]);
    sets.union_set(triangle[0], triangle[2]);
  }
  std::vector<int> islands;
  int next = 0;
  for (const auto& triangle : mesh.uv_triangles.rowwise()) {
    int& of_part = number[static_cast<std::size_t>(sets.find_set(triangle[0]))];
    if (of_part < 0) of_part = next++;
    islands.push_back(of_part);
  }
  return islands;
}

Eigen::MatrixX3d slideAlongUvs(const TriangleMesh& mesh, const Eigen::MatrixX2d& vectors) {
  assert(vectors.rows() == mesh.uvs.rows());
  const std::vector<int> islands = uvIslands(mesh);
  std::vector<int> island_of(static_cast<std::size_t>(mesh.uvs.rows()), -1);
  Eigen::MatrixX3d plane = Eigen::MatrixX3d::Zero(mesh.uvs.rows(), 3);
  plane.leftCols<2>() = mesh.uvs;
  for (Eigen::Index t = 0; t < mesh.uv_triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      island_of[static_cast<std::size_t>(mesh.uv_triangles(t, k))] = islands[static_cast<std::size_t>(t)];
    }
  }
  const ClosestSurface layout(plane, mesh.uv_triangles);
  // Where the UV leads; the vertex's own place where there is no way at all.
  const auto led = [&](int uv, int vertex) -> Eigen::RowVector3d {
    Eigen::RowVector2d step = vectors.row(uv);
    for (int halving = 0; halving < kHalvings && !step.isZero(0.0); ++halving, step *= 0.5) {
      const Eigen::RowVector2d place = mesh.uvs.row(uv) + step;
      const SurfacePoint point = layout.closest(Eigen::Vector3d(place.x(), place.y(), 0.0), kInside);
      if (!point.found()) continue;
      if (islands[static_cast<std::size_t>(point.triangle)] != island_of[static_cast<std::size_t>(uv)]) continue;
      return point.barycentric.transpose() * mesh.positions(mesh.triangles.row(point.triangle), Eigen::all);
    }
    return mesh.positions.row(vertex);
  };
  Eigen::MatrixX3d sums = Eigen::MatrixX3d::Zero(mesh.positions.rows(), 3);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(mesh.positions.rows());
  std::vector<int> vertex_of(static_cast<std::size_t>(mesh.uvs.rows()), -1);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int uv = mesh.uv_triangles(t, k), vertex = mesh.triangles(t, k);
      if (vertex_of[static_cast<std::size_t>(uv)] == vertex) continue;  // once for each UV of a vertex
      vertex_of[static_cast<std::size_t>(uv)] = vertex;
      sums.row(vertex) += led(uv, vertex);
      counts[vertex] += 1.0;
    }
  }
  Eigen::MatrixX3d positions = mesh.positions;
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (counts[v] > 0.0) positions.row(v) = sums.row(v) / counts[v];
  }
  return positions;
}

}  // namespace facezip::geometry
