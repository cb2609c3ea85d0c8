// Reference for kernels/cl/difference_settle.cl: what decoded textures leave at one texel, in double and without factors.
#pragma once

#include <Eigen/Dense>

namespace facezip::reference {

/// |delta - w^T D|^2. w  C x N; delta  N x channels; d  C x channels
inline double settledError(const Eigen::MatrixXd& w, const Eigen::MatrixXd& delta, const Eigen::MatrixXd& d) {
  return (delta - w.transpose() * d).squaredNorm();
}

}  // namespace facezip::reference
