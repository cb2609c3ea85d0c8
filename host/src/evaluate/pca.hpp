// pca.hpp - what principal component analysis would leave, from the Gram matrix of the differences alone.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace facezip::evaluate {

/// Squared error of every expression after projection on the first `components` principal components, the neutral as
/// mean (as the paper's baseline). With G = U L U^T the residual of expression n is G_nn - sum over j of L_j U_nj^2: no
/// texture is needed beyond their N x N inner products. gram  N x N, Delta_n . Delta_m over the covered texels
std::vector<double> pcaSquaredErrors(const Eigen::MatrixXd& gram, int components);

}  // namespace facezip::evaluate
