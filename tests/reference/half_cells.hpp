// Reference for kernels/cl/half_cell_*.cl: one half cell at a time in double.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace facezip::reference {

/// Weight of cell q at the centre of half cell h, along one axis: the bilinear hat with the edge repeated.
inline double halfCellShare(int h, int q, int cells) {
  const double position = std::clamp((h + 0.5) / 2.0 - 0.5, 0.0, cells - 1.0);
  return std::max(0.0, 1.0 - std::abs(position - q));
}

/// What the textures that suit weights w (C x N) add to the equations, and their squared error.
struct HalfCellFit {
  Eigen::MatrixXd block;  ///< sum of D D^T, C x C
  Eigen::MatrixXd sides;  ///< sum of D Delta^T, C x N
  double error = 0.0;
};

/// deltas  square root of the texel weight times Delta of each texel and channel, N x (texels * channels)
inline HalfCellFit fitHalfCell(const Eigen::MatrixXd& w, const Eigen::MatrixXd& deltas, double ridge) {
  if (deltas.cols() == 0) {  // Eigen's solver takes no right-hand side for a mistake
    return {Eigen::MatrixXd::Zero(w.rows(), w.rows()), Eigen::MatrixXd::Zero(w.rows(), w.cols()), 0.0};
  }
  const Eigen::MatrixXd a = w * w.transpose() + ridge * Eigen::MatrixXd::Identity(w.rows(), w.rows());
  const Eigen::MatrixXd d = a.ldlt().solve(w * deltas);
  return {d * d.transpose(), d * deltas.transpose(), (deltas - w.transpose() * d).squaredNorm()};
}

}  // namespace facezip::reference
