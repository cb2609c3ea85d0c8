#include "facezip/geometry/skin_strain.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "facezip/geometry/surface_gradient.hpp"

namespace facezip::geometry {
namespace {

using Six = Eigen::Matrix<double, 1, 6>;

Six toSix(const Eigen::Matrix3d& tensor) {
  const double root = std::sqrt(2.0);
  Six six;
  six << tensor(0, 0), tensor(1, 1), tensor(2, 2), root * tensor(1, 2), root * tensor(2, 0), root * tensor(0, 1);
  return six;
}

Eigen::Matrix3d fromSix(const Eigen::Ref<const Six>& six) {
  const double half = std::sqrt(0.5);
  Eigen::Matrix3d tensor;
  tensor << six[0], half * six[5], half * six[4], half * six[5], six[1], half * six[3], half * six[4], half * six[3],
      six[2];
  return tensor;
}

/// Strain of a triangle in its plane, as a tensor in space: the square root of C = F^T F, minus the identity.
Eigen::Matrix3d strainOf(const Eigen::Matrix<double, 2, 3>& axes, const Eigen::Matrix<double, 2, 3>& derivatives) {
  const Eigen::Matrix<double, 2, 3> moved = axes + derivatives;  // what becomes of the axes
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(moved * moved.transpose());
  const Eigen::Vector2d ratio = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().array() - 1.0;
  const Eigen::Matrix2d strain = solver.eigenvectors() * ratio.asDiagonal() * solver.eigenvectors().transpose();
  return axes.transpose() * strain * axes;
}

}  // namespace

SkinStrain::SkinStrain(Eigen::MatrixX3d neutral, Eigen::MatrixX3i triangles)
    : neutral_(std::move(neutral)), triangles_(std::move(triangles)), average_(neutral_.rows(), neutral_.rows()) {
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto edge = std::minmax({triangles_(t, corner), triangles_(t, (corner + 1) % 3)});
      if (edge.first != edge.second) edges_.push_back(edge);
    }
  }
  std::sort(edges_.begin(), edges_.end());
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  Eigen::VectorXd count = Eigen::VectorXd::Ones(neutral_.rows());
  for (const auto& [a, b] : edges_) ++count[a], ++count[b];
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [a, b] : edges_) {
    entries.emplace_back(a, b, 1.0 / count[a]);
    entries.emplace_back(b, a, 1.0 / count[b]);
  }
  for (int v = 0; v < neutral_.rows(); ++v) entries.emplace_back(v, v, 1.0 / count[v]);
  average_.setFromTriplets(entries.begin(), entries.end());
}

Eigen::VectorXd SkinStrain::ringLengths(const Eigen::MatrixX3d& positions) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(positions.rows());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(positions.rows());
  for (const auto& [a, b] : edges_) {
    const double length = (positions.row(a) - positions.row(b)).norm();
    sum[a] += length, sum[b] += length;
    ++count[a], ++count[b];
  }
  return sum.array() / count.array().max(1.0);
}

Eigen::VectorXd SkinStrain::edgeChange(const Eigen::MatrixX3d& posed) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(posed.rows());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(posed.rows());
  for (const auto& [a, b] : edges_) {
    const double before = (neutral_.row(a) - neutral_.row(b)).norm();
    if (before <= 0.0) continue;
    const double change = (posed.row(a) - posed.row(b)).norm() / before - 1.0;
    sum[a] += change * change, sum[b] += change * change;
    ++count[a], ++count[b];
  }
  return (sum.array() / count.array().max(1.0)).sqrt();
}

Eigen::MatrixXd SkinStrain::tensors(const Eigen::MatrixX3d& posed, int rounds) const {
  const SurfaceGradient gradient(neutral_, triangles_);
  const Eigen::MatrixXd derivatives = gradient.of(posed - neutral_);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(neutral_.rows(), 6);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(neutral_.rows());
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    if (gradient.areas()[t] <= 0.0) continue;
    const Six strain = toSix(strainOf(gradient.axes().middleRows<2>(2 * t), derivatives.middleRows<2>(2 * t)));
    for (int corner = 0; corner < 3; ++corner) {
      sum.row(triangles_(t, corner)) += gradient.areas()[t] * strain;
      area[triangles_(t, corner)] += gradient.areas()[t];
    }
  }
  for (Eigen::Index v = 0; v < sum.rows(); ++v) {
    if (area[v] > 0.0) sum.row(v) /= area[v];
  }
  const Eigen::MatrixXd strain = smoothed(std::move(sum), rounds);
  Eigen::MatrixXd parts(strain.rows(), 12);
  for (Eigen::Index v = 0; v < strain.rows(); ++v) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(fromSix(strain.row(v)));
    const auto part = [&](const Eigen::Vector3d& values) {
      return toSix(solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose());
    };
    parts.row(v) << part(solver.eigenvalues().cwiseMax(0.0)), part((-solver.eigenvalues()).cwiseMax(0.0));
  }
  return parts;
}

Eigen::MatrixXd SkinStrain::smoothed(Eigen::MatrixXd field, int rounds) const {
  for (int round = 0; round < rounds; ++round) field = average_ * field;
  return field;
}

}  // namespace facezip::geometry
