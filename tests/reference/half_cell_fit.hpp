// Reference for kernels/cl/half_cell_fit.cl: one half cell at a time in double, by the textures of its texels.
#pragma once

#include <Eigen/Dense>

namespace facezip::reference {

/// What the textures that suit weights w (C x N) add to the equations, and their squared error.
struct HalfCellFit {
  Eigen::MatrixXd block;  ///< sum of D D^T, C x C
  Eigen::MatrixXd sides;  ///< sum of D Delta^T, C x N
  double error = 0.0;
};

/// deltas  root of the texel weight times Delta of each texel and channel, N x (texels * channels)
inline HalfCellFit fitHalfCell(const Eigen::MatrixXd& w, const Eigen::MatrixXd& deltas, double ridge) {
  if (deltas.cols() == 0) {  // Eigen's solver takes no right-hand side for a mistake
    return {Eigen::MatrixXd::Zero(w.rows(), w.rows()), Eigen::MatrixXd::Zero(w.rows(), w.cols()), 0.0};
  }
  const Eigen::MatrixXd a = w * w.transpose() + ridge * Eigen::MatrixXd::Identity(w.rows(), w.rows());
  const Eigen::MatrixXd d = a.ldlt().solve(w * deltas);
  return {d * d.transpose(), d * deltas.transpose(), (deltas - w.transpose() * d).squaredNorm()};
}

}  // namespace facezip::reference
