#include "facezip/geometry/identity_basis.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace facezip::geometry {
namespace {

/// Variances below this share of the largest are rounding, and so are those this far below the mesh's own squares.
constexpr double kNothing = 1e-9;
constexpr double kRounding = 1e-20;

}  // namespace

Eigen::VectorXd IdentityBasis::scores(const Eigen::MatrixX3d& neutral) const {
  const Eigen::MatrixX3d difference = neutral - mean;
  return axes.transpose() * difference.reshaped();
}

IdentityBasis identityBasis(std::span<const Eigen::MatrixX3d> neutrals) {
  assert(neutrals.size() >= 2);
  const auto subjects = static_cast<Eigen::Index>(neutrals.size());
  IdentityBasis basis;
  basis.mean = Eigen::MatrixX3d::Zero(neutrals[0].rows(), 3);
  for (const Eigen::MatrixX3d& neutral : neutrals) basis.mean += neutral / static_cast<double>(subjects);
  Eigen::MatrixXd differences(basis.mean.size(), subjects);
  for (Eigen::Index s = 0; s < subjects; ++s) {
    differences.col(s) = (neutrals[static_cast<std::size_t>(s)] - basis.mean).reshaped();
  }
  // Few subjects and many vertices: the components follow from the subjects' inner products.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(differences.transpose() * differences);
  const Eigen::VectorXd variances = solver.eigenvalues().reverse();
  const double least = std::max(kNothing * variances[0], kRounding * basis.mean.squaredNorm());
  Eigen::Index count = 0;
  while (count < subjects && variances[count] > least) ++count;
  basis.axes.resize(differences.rows(), count);
  basis.deviations.resize(count);
  const double root = std::sqrt(static_cast<double>(subjects));
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd vector = solver.eigenvectors().col(subjects - 1 - k);
    Eigen::VectorXd axis = differences * (vector * (root / variances[k]));
    Eigen::Index largest = 0;  // an eigenvector's sign is arbitrary: the same on any machine
    axis.cwiseAbs().maxCoeff(&largest);
    basis.axes.col(k) = axis[largest] < 0.0 ? -axis : axis;
    basis.deviations[k] = std::sqrt(variances[k]) / root;
  }
  return basis;
}

IdentityBasis leading(const IdentityBasis& basis, Eigen::Index count) {
  return {basis.mean, basis.axes.leftCols(count), basis.deviations.head(count)};
}

}  // namespace facezip::geometry
