// Reference for kernels/cl/difference_fit.cl: the textures that suit given weights at one texel, in double.
#pragma once

#include <Eigen/Dense>

namespace facezip::reference {

/// D (C x channels) that minimises |delta - w^T D|^2 + ridge |D|^2; w is C x N, delta N x channels.
inline Eigen::MatrixXd fitDifference(const Eigen::MatrixXd& w, const Eigen::MatrixXd& delta, double ridge) {
  const Eigen::MatrixXd a = w * w.transpose() + ridge * Eigen::MatrixXd::Identity(w.rows(), w.rows());
  return a.ldlt().solve(w * delta);
}

}  // namespace facezip::reference
