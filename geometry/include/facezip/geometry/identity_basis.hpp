// identity_basis.hpp - what tells one neutral face from another, in a few numbers.
#pragma once

#include <Eigen/Core>
#include <span>

namespace facezip::geometry {

/// Principal components of neutrals, in units of their standard deviations.
struct IdentityBasis {
  Eigen::MatrixX3d mean;       ///< #V by 3
  Eigen::MatrixXd axes;        ///< 3 #V by D, rows x of all vertices first: scores are axes^T (neutral - mean)
  Eigen::VectorXd deviations;  ///< D, falling: root mean square length of a component over the subjects, in the unit

  Eigen::Index size() const { return axes.cols(); }
  /// D numbers of a neutral, #V by 3, that lies as the mean does (aligned()). Their mean square over the subjects is 1.
  Eigen::VectorXd scores(const Eigen::MatrixX3d& neutral) const;
};

/// All components that the subjects span: D is their number less 1, or less where some repeat others.
/// neutrals  S >= 2, #V by 3 each, of one frame
IdentityBasis identityBasis(std::span<const Eigen::MatrixX3d> neutrals);

/// The first `count` components.
IdentityBasis leading(const IdentityBasis& basis, Eigen::Index count);

}  // namespace facezip::geometry
