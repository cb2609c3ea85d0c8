// Reference for kernels/cl/half_cell_gram.cl: the Gram matrix of one half cell in double.
#pragma once

#include <Eigen/Dense>

namespace facezip::reference {

/// deltas  root of the texel weight times Delta of each texel and channel, N x (texels * channels)
inline Eigen::MatrixXd halfCellGram(const Eigen::MatrixXd& deltas) { return deltas * deltas.transpose(); }

}  // namespace facezip::reference
