#include "facezip/geometry/surface_deformation.hpp"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>

#include "facezip/error.hpp"
#include "facezip/geometry/mesh_edges.hpp"
#include "facezip/geometry/surface_gradient.hpp"

namespace facezip::geometry {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// The angle's sine below which a cotangent is cut: slivers would outweigh all else.
constexpr double kLeastSine = 0.02;

double cotangent(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
  const double sine = a.cross(b).norm();
  return a.dot(b) / std::max(sine, kLeastSine * a.norm() * b.norm());
}

/// An interior edge with the corners that face it.
struct Hinge {
  int edge[2];
  int opposite[2];
  int triangles[2];
};

std::vector<Hinge> hingesOf(const Eigen::MatrixX3i& triangles) {
  struct Side {
    std::array<int, 2> edge;
    int opposite;
    int triangle;
  };
  std::vector<Side> sides;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({triangles(t, (k + 1) % 3), triangles(t, (k + 2) % 3)});
      sides.push_back({{low, high}, triangles(t, k), static_cast<int>(t)});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle; });
  std::vector<Hinge> hinges;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side &a = sides[i - 1], &b = sides[i];
    if (a.edge != b.edge || a.edge[0] == a.edge[1]) continue;
    hinges.push_back({{a.edge[0], a.edge[1]}, {a.opposite, b.opposite}, {a.triangle, b.triangle}});
  }
  return hinges;
}

/// One row an interior edge: sqrt(3 / A_e) k_e. In rows, its Gram matrix is the bending energy.
Sparse bendingRows(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, const Eigen::VectorXd& areas) {
  const std::vector<Hinge> hinges = hingesOf(triangles);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * hinges.size());
  for (std::size_t i = 0; i < hinges.size(); ++i) {
    const Hinge& hinge = hinges[i];
    const double area = areas[hinge.triangles[0]] + areas[hinge.triangles[1]];
    if (!(area > 0.0)) continue;
    const Eigen::RowVector3d p = positions.row(hinge.edge[0]), q = positions.row(hinge.edge[1]);
    double at_p = 0.0, at_q = 0.0;
    const double scale = std::sqrt(3.0 / area);
    for (const int side : {0, 1}) {
      const Eigen::RowVector3d r = positions.row(hinge.opposite[side]);
      const double cot_p = cotangent(q - p, r - p), cot_q = cotangent(p - q, r - q);
      at_p += cot_q;
      at_q += cot_p;
      entries.emplace_back(static_cast<int>(i), hinge.opposite[side], -scale * (cot_p + cot_q));
    }
    entries.emplace_back(static_cast<int>(i), hinge.edge[0], scale * at_p);
    entries.emplace_back(static_cast<int>(i), hinge.edge[1], scale * at_q);
  }
  Sparse rows(static_cast<Eigen::Index>(hinges.size()), positions.rows());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

Sparse smoothnessOf(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, const Stiffness& stiffness) {
  const SurfaceGradient gradient(positions, triangles);
  const Sparse bending = bendingRows(positions, triangles, gradient.areas());
  Eigen::VectorXd membrane(2 * triangles.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const double factor = stiffness.membrane_factor.size() > 0 ? stiffness.membrane_factor[t] : 1.0;
    membrane.segment<2>(2 * t).setConstant(stiffness.membrane * stiffness.membrane * factor * gradient.areas()[t]);
  }
  Sparse smooth = std::pow(stiffness.bending, 4) * Sparse(bending.transpose() * bending);
  smooth += Sparse(gradient.matrix().transpose() * membrane.asDiagonal() * gradient.matrix());
  const Eigen::VectorXd areas = vertexAreas(positions, triangles);
  smooth += Sparse(Eigen::VectorXd(stiffness.anchor * areas).asDiagonal());
  return smooth;
}

/// What targets add to the left-hand side, applied to displacements.
void addTargets(const std::vector<PointTarget>& targets, const Eigen::MatrixX3d& x, Eigen::MatrixX3d& out) {
  for (const PointTarget& target : targets) {
    Eigen::RowVector3d point = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) point += target.barycentric[k] * x.row(target.vertices[k]);
    const Eigen::RowVector3d pull = point * target.metric;
    for (int k = 0; k < 3; ++k) out.row(target.vertices[k]) += target.barycentric[k] * pull;
  }
}

}  // namespace

SurfaceDeformation::SurfaceDeformation(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles,
                                       const Stiffness& stiffness, const Eigen::VectorXd& density)
    : smooth_(smoothnessOf(positions, triangles, stiffness)) {
  assert(density.size() == positions.rows());
  const Eigen::VectorXd areas = vertexAreas(positions, triangles);
  Eigen::VectorXd diagonal = areas.cwiseProduct(density);
  // Vertices of no triangle, and what nothing holds: any weight will do.
  diagonal.array() += 1e-9 * std::max(areas.mean(), 1e-300);
  Sparse system = smooth_;
  system += Sparse(diagonal.asDiagonal());
  factor_.compute(system);
  if (factor_.info() != Eigen::Success) {
    throw SolverError("deformation of the template", static_cast<long>(positions.rows()), std::nan(""));
  }
}

Eigen::MatrixX3d SurfaceDeformation::solve(const std::vector<PointTarget>& targets, const Eigen::MatrixX3d& rest,
                                           const Eigen::MatrixX3d& start, int rounds, double tolerance) const {
  const auto apply = [&](const Eigen::MatrixX3d& x) {
    Eigen::MatrixX3d out = smooth_ * x;
    addTargets(targets, x, out);
    return out;
  };
  // Right-hand side for displacements from rest: targets less where rest has their points.
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(rest.rows(), 3);
  for (const PointTarget& target : targets) {
    Eigen::RowVector3d missing = target.target;
    for (int k = 0; k < 3; ++k) missing -= target.barycentric[k] * rest.row(target.vertices[k]);
    const Eigen::RowVector3d pull = missing * target.metric;
    for (int k = 0; k < 3; ++k) right.row(target.vertices[k]) += target.barycentric[k] * pull;
  }
  Eigen::MatrixX3d x = start - rest;
  Eigen::MatrixX3d residual = right - apply(x);
  Eigen::MatrixX3d scaled = factor_.solve(residual);
  Eigen::MatrixX3d direction = scaled;
  double product = residual.cwiseProduct(scaled).sum();
  const double goal = tolerance * tolerance * product;
  for (int round = 0; round < rounds && product > goal && product > 0.0; ++round) {
    const Eigen::MatrixX3d image = apply(direction);
    const double step = product / direction.cwiseProduct(image).sum();
    x += step * direction;
    residual -= step * image;
    scaled = factor_.solve(residual);
    const double next = residual.cwiseProduct(scaled).sum();
    direction = scaled + (next / product) * direction;
    product = next;
  }
  return rest + x;
}

}  // namespace facezip::geometry
