// pca.hpp - what principal component analysis would leave, from the Gram matrix of the differences.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "bands/tile_band.hpp"

namespace facezip::evaluate {

/// Squared error of every expression after projection on the first `components` principal components, the neutral as
/// mean (as the paper's baseline). With G = U L U^T the residual of expression n is G_nn - sum over j of L_j U_nj^2: no
/// texture is needed beyond their N x N inner products. gram  N x N, Delta_n . Delta_m over the covered texels
std::vector<double> pcaSquaredErrors(const Eigen::MatrixXd& gram, int components);

/// P = U_k U_k^T, N x N: PCA's reconstruction of expression m is sum over n of P_nm Delta_n.
Eigen::MatrixXd pcaProjector(const Eigen::MatrixXd& gram, int components);

/// Errors that the projection leaves at some texels: #texels x N, root mean square over channels, in 1/255.
/// samples  neutral, then expressions, as a MapBand has them
/// texels   as compress::coveredTexels() gives them
Eigen::MatrixXf pcaTexelErrors(std::span<const std::byte> samples, const compress::BandShape& shape,
                               std::span<const std::uint32_t> texels, const Eigen::MatrixXd& projector);

}  // namespace facezip::evaluate
