#include "synth/skin_state.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace facezip::synth {
namespace {

// Smoothing passes; an edge is about 2 mm over the features.
constexpr int kStrainPasses = 2;  // takes the facets out of the strain, keeps folds of 6 mm
constexpr int kBloodPasses = 20;  // blood moves about a centimetre

/// Edge vectors of triangle f in a plane: columns are corners 1 and 2 relative to corner 0, x axis along `axis`.
Eigen::Matrix2d edgesInPlane(const Eigen::Vector3d& edge1, const Eigen::Vector3d& edge2, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d normal = edge1.cross(edge2).normalized();
  const Eigen::Vector3d x = (axis - axis.dot(normal) * normal).normalized();
  const Eigen::Vector3d y = normal.cross(x);
  Eigen::Matrix2d edges;
  edges << edge1.dot(x), edge2.dot(x), edge1.dot(y), edge2.dot(y);
  return edges;
}

struct TriangleStrain {
  Eigen::Vector2d compression = Eigen::Vector2d::Zero();
  double log_area = 0.0;
  Eigen::Vector2d metres_per_uv = Eigen::Vector2d::Zero();
};

TriangleStrain triangleStrain(const geometry::TriangleMesh& neutral, const Eigen::MatrixX3d& positions,
                              Eigen::Index f) {
  const auto corners = neutral.triangles.row(f);
  const auto edge = [&](const Eigen::MatrixX3d& from, int k) {
    return Eigen::Vector3d(from.row(corners(k)) - from.row(corners(0)));
  };
  Eigen::Matrix2d uv_edges;
  uv_edges.col(0) = (neutral.uvs.row(corners(1)) - neutral.uvs.row(corners(0))).transpose();
  uv_edges.col(1) = (neutral.uvs.row(corners(2)) - neutral.uvs.row(corners(0))).transpose();
  const Eigen::Matrix2d uv_inverse = uv_edges.inverse();
  Eigen::Matrix<double, 3, 2> rest_edges, now_edges;
  rest_edges << edge(neutral.positions, 1), edge(neutral.positions, 2);
  now_edges << edge(positions, 1), edge(positions, 2);

  // Stretch C = F^T F in the plane of the neutral triangle, x along u.
  const Eigen::Matrix<double, 3, 2> rest_axes = rest_edges * uv_inverse;
  const Eigen::Matrix<double, 3, 2> now_axes = now_edges * uv_inverse;
  const Eigen::Matrix2d rest = edgesInPlane(rest_edges.col(0), rest_edges.col(1), rest_axes.col(0));
  const Eigen::Matrix2d now = edgesInPlane(now_edges.col(0), now_edges.col(1), now_axes.col(0));
  const Eigen::Matrix2d gradient = now * rest.inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> stretch(gradient.transpose() * gradient);
  const double shortest = std::sqrt(std::max(stretch.eigenvalues()(0), 1e-12));
  const Eigen::Vector2d direction = stretch.eigenvectors().col(0);

  TriangleStrain strain;
  const double compression = std::clamp(1.0 - shortest, 0.0, 0.8);
  strain.compression << compression * (direction.x() * direction.x() - direction.y() * direction.y()),
      compression * 2.0 * direction.x() * direction.y();
  strain.log_area = std::clamp(std::log(std::max(std::abs(gradient.determinant()), 1e-6)), -1.5, 1.5);
  strain.metres_per_uv << now_axes.col(0).norm(), now_axes.col(1).norm();
  return strain;
}

}  // namespace

std::vector<SkinState> skinStates(const HeadMesh& neutral, const Eigen::MatrixX3d& positions) {
  const std::size_t vertex_count = neutral.grid.size();
  std::vector<Eigen::Vector2d> compression(vertex_count, Eigen::Vector2d::Zero());
  std::vector<Eigen::Vector2d> metres_per_uv(vertex_count, Eigen::Vector2d::Zero());
  std::vector<double> log_area(vertex_count, 0.0);
  std::vector<double> shares(vertex_count, 0.0);
  for (Eigen::Index f = 0; f < neutral.mesh.triangles.rows(); ++f) {
    const TriangleStrain strain = triangleStrain(neutral.mesh, positions, f);
    for (const int corner : neutral.mesh.triangles.row(f)) {
      const auto v = static_cast<std::size_t>(corner);
      compression[v] += strain.compression;
      metres_per_uv[v] += strain.metres_per_uv;
      log_area[v] += strain.log_area;
      shares[v] += 1.0;
    }
  }
  for (std::size_t v = 0; v < vertex_count; ++v) {
    compression[v] /= shares[v];
    metres_per_uv[v] /= shares[v];
    log_area[v] /= shares[v];
  }
  smoothOverRings(neutral.rings, kStrainPasses, compression);
  smoothOverRings(neutral.rings, kBloodPasses, log_area);
  std::vector<double> openness = ambientOpenness(positions, neutral.mesh.triangles);
  smoothOverRings(neutral.rings, 1, openness);

  std::vector<SkinState> states(vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    states[v] = {static_cast<float>(compression[v].x()),   static_cast<float>(compression[v].y()),
                 static_cast<float>(log_area[v]),          static_cast<float>(openness[v]),
                 static_cast<float>(metres_per_uv[v].x()), static_cast<float>(metres_per_uv[v].y())};
  }
  return states;
}

}  // namespace facezip::synth
