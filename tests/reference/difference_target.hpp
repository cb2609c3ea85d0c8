// Reference for kernels/cl/difference_target.cl: textures that are coded one after the other, at one texel, in double and
// without factors.
#pragma once

#include <Eigen/Dense>

namespace facezip::reference {

/// What texture i should be where those behind it are `d` already: the minimum of |delta - w^T D|^2 + ridge |D|^2 over
/// textures 0 to i, row i of it. w  C x N; delta  N x channels; d  C x channels, rows beyond i count
inline Eigen::RowVectorXd textureTarget(const Eigen::MatrixXd& w, const Eigen::MatrixXd& delta,
                                        const Eigen::MatrixXd& d, int i, double ridge) {
  const Eigen::Index behind = w.rows() - i - 1;
  const Eigen::MatrixXd left = delta - w.bottomRows(behind).transpose() * d.bottomRows(behind);
  const Eigen::MatrixXd free = w.topRows(i + 1);
  const Eigen::MatrixXd a = free * free.transpose() + ridge * Eigen::MatrixXd::Identity(i + 1, i + 1);
  return a.ldlt().solve(free * left).row(i);
}

}  // namespace facezip::reference
