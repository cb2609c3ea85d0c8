#include "evaluate/pca.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace facezip::evaluate {

std::vector<double> pcaSquaredErrors(const Eigen::MatrixXd& gram, int components) {
  const Eigen::Index count = gram.rows();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);  // eigenvalues ascending
  const Eigen::Index kept = std::min<Eigen::Index>(components, count);
  const auto values = solver.eigenvalues().tail(kept).array();
  const auto vectors = solver.eigenvectors().rightCols(kept).array();
  const Eigen::ArrayXd explained = (vectors.square().rowwise() * values.transpose()).rowwise().sum();
  std::vector<double> errors(static_cast<std::size_t>(count));
  for (Eigen::Index n = 0; n < count; ++n) {
    errors[static_cast<std::size_t>(n)] = std::max(0.0, gram(n, n) - explained(n));  // rounding may pass below zero
  }
  return errors;
}

}  // namespace facezip::evaluate
