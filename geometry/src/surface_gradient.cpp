#include "facezip/geometry/surface_gradient.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "facezip/error.hpp"

namespace facezip::geometry {
namespace {

// Height over longest edge below which a triangle has no direction worth differentiating along.
constexpr double kSliver = 1e-6;

}  // namespace

SurfaceGradient::SurfaceGradient(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles)
    : operator_(2 * triangles.rows(), positions.rows()),
      axes_(Eigen::MatrixX3d::Zero(2 * triangles.rows(), 3)),
      areas_(Eigen::VectorXd::Zero(triangles.rows())) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(6 * static_cast<std::size_t>(triangles.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d a = positions.row(triangles(t, 0));
    const Eigen::RowVector3d ab = positions.row(triangles(t, 1)) - a;
    const Eigen::RowVector3d ac = positions.row(triangles(t, 2)) - a;
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    const double twice_area = ab.cross(ac).norm();
    if (!(twice_area > kSliver * longest)) {
      ++degenerate_;
      continue;
    }
    const Eigen::RowVector3d x = ab.normalized();
    const Eigen::RowVector3d y = (ac - ac.dot(x) * x).normalized();
    axes_.row(2 * t) = x;
    axes_.row(2 * t + 1) = y;
    areas_[t] = 0.5 * twice_area;
    // In the axes b = (p, 0) and c = (q, r): a linear f has f_x = (f_b - f_a) / p, f_y = (f_c - f_a - q f_x) / r.
    const double p = ab.norm(), q = ac.dot(x), r = ac.dot(y);
    const auto put = [&](Eigen::Index row, double at_a, double at_b, double at_c) {
      entries.emplace_back(row, triangles(t, 0), at_a);
      entries.emplace_back(row, triangles(t, 1), at_b);
      entries.emplace_back(row, triangles(t, 2), at_c);
    };
    put(2 * t, -1 / p, 1 / p, 0);
    put(2 * t + 1, (q / p - 1) / r, -q / (p * r), 1 / r);
  }
  operator_.setFromTriplets(entries.begin(), entries.end());
}

ScreenedPoisson::ScreenedPoisson(const SurfaceGradient& gradient, const Eigen::MatrixX3i& triangles, double screening)
    : anchor_(Eigen::VectorXd::Zero(gradient.vertices())) {
  Eigen::VectorXd weights(2 * gradient.triangles());
  for (Eigen::Index t = 0; t < gradient.triangles(); ++t) {
    weights.segment<2>(2 * t).setConstant(gradient.areas()[t]);
    for (int corner = 0; corner < 3; ++corner) anchor_[triangles(t, corner)] += gradient.areas()[t] / 3;
  }
  // Vertices of no triangle, or of degenerate ones alone, have nothing but their anchor: any weight will do.
  const double mean = std::max(anchor_.mean(), 1e-300);
  anchor_ = (anchor_.array() > 1e-12 * mean).select(anchor_, mean) / (screening * screening);
  divergence_ = gradient.matrix().transpose() * weights.asDiagonal();
  Eigen::SparseMatrix<double> system = divergence_ * gradient.matrix();
  system += Eigen::SparseMatrix<double>(anchor_.asDiagonal());
  factor_.compute(system);
  if (factor_.info() != Eigen::Success) {
    throw SolverError("shapes from their gradients", static_cast<long>(gradient.vertices()), std::nan(""));
  }
}

Eigen::MatrixXd ScreenedPoisson::solve(const Eigen::MatrixXd& divergence,
                                       const Eigen::Ref<const Eigen::MatrixXd>& near) const {
  return factor_.solve(divergence + anchor_.asDiagonal() * near);
}

}  // namespace facezip::geometry
