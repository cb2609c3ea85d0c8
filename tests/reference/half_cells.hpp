// Reference for kernels/cl/half_cell_*.cl: one half cell at a time in double, its shares of cells by numerical means.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace facezip::reference {

/// Mean over half cell h, along one axis, of f(position in cells), the edge repeated.
template <typename Function>
double meanOfHalfCell(int h, int cells, const Function& f) {
  constexpr int kSteps = 512;
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double position = (h + (k + 0.5) / kSteps) / 2.0 - 0.5;
    sum += f(std::clamp(position, 0.0, cells - 1.0));
  }
  return sum / kSteps;
}

inline double hatAt(double position, int q) { return std::max(0.0, 1.0 - std::abs(position - q)); }

/// Mean of the hat of cell q, and of the product of those of q and r.
inline double halfCellShare(int h, int q, int cells) {
  return meanOfHalfCell(h, cells, [&](double x) { return hatAt(x, q); });
}
inline double halfCellProduct(int h, int q, int r, int cells) {
  return meanOfHalfCell(h, cells, [&](double x) { return hatAt(x, q) * hatAt(x, r); });
}

/// What the textures that suit weights w (C x N) add to the equations, and their squared error.
struct HalfCellFit {
  Eigen::MatrixXd block;  ///< sum of D D^T, C x C
  Eigen::MatrixXd sides;  ///< sum of D Delta^T, C x N
  double error = 0.0;
};

/// deltas  square root of the texel weight times Delta of each texel and channel, N x (texels * channels)
inline HalfCellFit fitHalfCell(const Eigen::MatrixXd& w, const Eigen::MatrixXd& deltas, double ridge) {
  const Eigen::MatrixXd a = w * w.transpose() + ridge * Eigen::MatrixXd::Identity(w.rows(), w.rows());
  const Eigen::MatrixXd d = a.ldlt().solve(w * deltas);
  return {d * d.transpose(), d * deltas.transpose(), (deltas - w.transpose() * d).squaredNorm()};
}

}  // namespace facezip::reference
