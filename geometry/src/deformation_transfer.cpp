#include "facezip/geometry/deformation_transfer.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cassert>
#include <cmath>

namespace facezip::geometry {
namespace {

constexpr double kStill = 1e-5;
// Screening length over the diagonal of the mesh, and rounds: together they let the largest structures settle to some
// hundredths of the shape's motion before still vertices are put back.
constexpr double kScreening = 0.25;
constexpr int kRounds = 8;

/// Edges and the normal, scaled to a length that goes with the edges' (Sumner and Popovic 2004, Eq. 1).
Eigen::Matrix3d frameOf(const Eigen::MatrixX3d& positions, const Eigen::RowVector3i& triangle) {
  Eigen::Matrix3d frame;
  const Eigen::RowVector3d ab = positions.row(triangle[1]) - positions.row(triangle[0]);
  const Eigen::RowVector3d ac = positions.row(triangle[2]) - positions.row(triangle[0]);
  const Eigen::RowVector3d normal = ab.cross(ac);
  const double length = std::sqrt(normal.norm());
  frame.col(0) = ab.transpose();
  frame.col(1) = ac.transpose();
  frame.col(2) = length > 0.0 ? Eigen::Vector3d(normal.transpose() / length) : Eigen::Vector3d::Zero();
  return frame;
}

}  // namespace

Eigen::MatrixX3d transferredGradient(const Eigen::MatrixX3d& neutral, const Eigen::MatrixX3d& shape,
                                     const Eigen::MatrixX3i& triangles, const SurfaceGradient& target,
                                     const Eigen::Matrix3d& turn) {
  const SurfaceGradient source(neutral, triangles);  // knows which triangles have no area
  Eigen::MatrixX3d wanted = Eigen::MatrixX3d::Zero(2 * triangles.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (source.areas()[t] <= 0.0 || target.areas()[t] <= 0.0) continue;
    const Eigen::Matrix3d before = frameOf(neutral, triangles.row(t));
    const Eigen::Matrix3d after = frameOf(shape, triangles.row(t));
    const Eigen::Matrix3d change = turn * (after - before) * before.inverse() * turn.transpose();
    for (int axis = 0; axis < 2; ++axis) {
      wanted.row(2 * t + axis) = (change * target.axes().row(2 * t + axis).transpose()).transpose();
    }
  }
  return wanted;
}

Eigen::MatrixX3d Similarity::apply(const Eigen::MatrixX3d& points) const {
  return applyToVectors(points).rowwise() + shift;
}

Eigen::MatrixX3d Similarity::applyToVectors(const Eigen::MatrixX3d& vectors) const {
  return scale * vectors * turn.transpose();
}

Eigen::Matrix3d rotationFrom(const Eigen::Matrix3d& covariance) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs[2] = -1.0;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Similarity fitSimilarity(const Eigen::MatrixX3d& from, const Eigen::MatrixX3d& to, const Eigen::VectorXd& weights_in,
                         bool fixed_scale) {
  assert(from.rows() == to.rows() && from.rows() >= 1);
  Eigen::VectorXd weights = weights_in.size() > 0 ? weights_in : Eigen::VectorXd::Ones(from.rows());
  weights /= weights.sum();
  const Eigen::RowVector3d from_centre = weights.transpose() * from;
  const Eigen::RowVector3d to_centre = weights.transpose() * to;
  const Eigen::MatrixX3d f = from.rowwise() - from_centre;
  const Eigen::MatrixX3d t = to.rowwise() - to_centre;
  const Eigen::Matrix3d covariance = t.transpose() * weights.asDiagonal() * f;
  Similarity found;
  found.turn = rotationFrom(covariance);
  const double spread = (weights.asDiagonal() * f).cwiseProduct(f).sum();
  if (!fixed_scale && spread > 0.0) found.scale = found.turn.cwiseProduct(covariance).sum() / spread;
  found.shift = to_centre - found.scale * from_centre * found.turn.transpose();
  return found;
}

double boundingDiagonal(const Eigen::MatrixX3d& positions) {
  return (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).norm();
}

Eigen::VectorXd stillVertices(const Eigen::MatrixX3d& neutral, const Eigen::MatrixX3d& displacement) {
  const double most = kStill * boundingDiagonal(neutral);
  return (displacement.rowwise().norm().array() <= most).cast<double>();
}

Eigen::MatrixXd solveShapes(const ScreenedPoisson& solver, const Eigen::MatrixXd& wanted, const Eigen::MatrixXd& still,
                            const Eigen::MatrixXd& start, int rounds) {
  assert(start.cols() == wanted.cols() && still.cols() * 3 == wanted.cols());
  Eigen::MatrixXd shapes = start;
  tbb::parallel_for(Eigen::Index{0}, still.cols(), [&](Eigen::Index m) {
    const Eigen::VectorXd moving = 1.0 - still.col(m).array();
    if (moving.isZero()) {
      shapes.middleCols<3>(3 * m).setZero();
      return;
    }
    const Eigen::MatrixXd divergence = solver.divergence(wanted.middleCols<3>(3 * m));
    for (int round = 0; round < rounds; ++round) {
      shapes.middleCols<3>(3 * m) = moving.asDiagonal() * solver.solve(divergence, shapes.middleCols<3>(3 * m));
    }
  });
  return shapes;
}

std::vector<Eigen::MatrixX3d> displacedShapes(const Eigen::MatrixX3d& source_neutral,
                                              const std::vector<Eigen::MatrixX3d>& source_shapes,
                                              const Eigen::MatrixX3d& target_neutral) {
  const Similarity place = fitSimilarity(source_neutral, target_neutral);
  std::vector<Eigen::MatrixX3d> shapes;
  for (const Eigen::MatrixX3d& shape : source_shapes) {
    const Eigen::MatrixX3d moved = shape - source_neutral;
    const Eigen::VectorXd moving = 1.0 - stillVertices(source_neutral, moved).array();
    shapes.push_back(moving.asDiagonal() * place.applyToVectors(moved));
  }
  return shapes;
}

std::vector<Eigen::MatrixX3d> transferShapes(const Eigen::MatrixX3d& source_neutral,
                                             const std::vector<Eigen::MatrixX3d>& source_shapes,
                                             const Eigen::MatrixX3d& target_neutral,
                                             const Eigen::MatrixX3i& triangles) {
  const auto count = static_cast<Eigen::Index>(source_shapes.size());
  const SurfaceGradient target(target_neutral, triangles);
  const ScreenedPoisson solver(target, triangles, kScreening * boundingDiagonal(target_neutral));
  const Similarity place = fitSimilarity(source_neutral, target_neutral);
  Eigen::MatrixXd wanted(2 * triangles.rows(), 3 * count);
  Eigen::MatrixXd still(target_neutral.rows(), count);
  Eigen::MatrixXd start(target_neutral.rows(), 3 * count);
  tbb::parallel_for(Eigen::Index{0}, count, [&](Eigen::Index m) {
    const Eigen::MatrixX3d& shape = source_shapes[static_cast<std::size_t>(m)];
    const Eigen::MatrixX3d moved = shape - source_neutral;
    wanted.middleCols<3>(3 * m) = transferredGradient(source_neutral, shape, triangles, target, place.turn);
    still.col(m) = stillVertices(source_neutral, moved);
    start.middleCols<3>(3 * m) = place.applyToVectors(moved);
  });
  const Eigen::MatrixXd solved = solveShapes(solver, wanted, still, start, kRounds);
  std::vector<Eigen::MatrixX3d> shapes;
  for (Eigen::Index m = 0; m < count; ++m) shapes.emplace_back(solved.middleCols<3>(3 * m));
  return shapes;
}

}  // namespace facezip::geometry
