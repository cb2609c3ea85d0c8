// texture_assignment.hpp - what clusters and permutation mean for expressions: the coefficients of Eq. 5 and 6.
#pragma once

#include <vector>

#include "search/kmeans.hpp"
#include "search/permutation_search.hpp"

namespace facezip::compress {

/// K x C x N: coefficient of Delta_n M_k in difference texture i (Eq. 5), which is 1 / |S| when n lies in the cluster
/// S = sigma(i, k) of mask k, and 0 otherwise; an empty cluster gives zeros.
///   D_i = sum_k M_k sum_n coefficient[k][i][n] Delta_n
std::vector<float> differenceCoefficients(const Clustering& clustering, const Permutation& permutation);

/// K x N: the texture i that expression n uses under mask k, that is the i with alpha_ink = 1 (Eq. 6): n lies in
/// cluster sigma(i, k) of mask k. The paper prints sigma^-1(i, k), which does not fit its Eq. 5.
std::vector<int> textureOfExpression(const Clustering& clustering, const Permutation& permutation);

}  // namespace facezip::compress
