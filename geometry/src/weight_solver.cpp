#include "facezip/geometry/weight_solver.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "facezip/geometry/bounded_least_squares.hpp"

namespace facezip::geometry {

Distances distancesBetween(const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b) {
  assert(a.rows() == b.rows());
  Distances found;
  if (a.rows() == 0) return found;
  Eigen::VectorXd lengths = (a - b).rowwise().norm();
  found.rms = std::sqrt(lengths.squaredNorm() / static_cast<double>(lengths.size()));
  found.mean = lengths.mean();
  found.largest = lengths.maxCoeff();
  const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(lengths.size() - 1));
  std::nth_element(lengths.data(), lengths.data() + rank, lengths.data() + lengths.size());
  found.percentile_99 = lengths[rank];
  return found;
}

WeightSolver::WeightSolver(Eigen::MatrixX3d neutral, const std::vector<Eigen::MatrixX3d>& shapes, std::vector<int> used)
    : neutral_(std::move(neutral)),
      basis_(3 * neutral_.rows(), static_cast<Eigen::Index>(shapes.size())),
      mask_(Eigen::VectorXd::Constant(neutral_.rows(), used.empty() ? 1.0 : 0.0)) {
  for (const int v : used) mask_[v] = 1.0;
  for (std::size_t m = 0; m < shapes.size(); ++m) {
    assert(shapes[m].rows() == neutral_.rows());
    basis_.col(static_cast<Eigen::Index>(m)) = shapes[m].reshaped();
  }
  const Eigen::MatrixXd seen = mask_.replicate(3, 1).asDiagonal() * basis_;
  hessian_ = seen.transpose() * seen;
}

Eigen::VectorXd WeightSolver::project(const Eigen::MatrixX3d& mesh) const {
  const Eigen::MatrixX3d moved = mask_.asDiagonal() * (mesh - neutral_);
  return basis_.transpose() * moved.reshaped();
}

Eigen::MatrixXd WeightSolver::products(const Eigen::MatrixX3d& points) const {
  const Eigen::MatrixX3d seen = mask_.asDiagonal() * points;
  Eigen::MatrixXd found(shapes(), 9);
  for (Eigen::Index a = 0; a < 3; ++a) {
    const Eigen::MatrixX3d along = basis_.middleRows(a * vertices(), vertices()).transpose() * seen;
    for (Eigen::Index b = 0; b < 3; ++b) found.col(a + 3 * b) = along.col(b);
  }
  return found;
}

Eigen::VectorXd WeightSolver::solve(const Eigen::VectorXd& projected, const Eigen::VectorXd& guess,
                                    double strength) const {
  const double pull = shapes() == 0 ? 0.0 : strength * hessian_.trace() / static_cast<double>(shapes());
  Eigen::MatrixXd h = hessian_;
  h.diagonal().array() += pull;
  return solveBounded(h, projected + pull * guess, guess, 0.0, 1.0);
}

Eigen::MatrixX3d WeightSolver::pose(const Eigen::VectorXd& weights) const {
  const Eigen::VectorXd moved = basis_ * weights;
  return neutral_ + moved.reshaped(neutral_.rows(), 3);
}

Similarity WeightSolver::headMotion(const Eigen::MatrixX3d& posed, const Eigen::MatrixX3d& mesh) const {
  return fitSimilarity(posed, mesh, mask_, /* fixed_scale= */ true);
}

}  // namespace facezip::geometry
