// centred_gram.hpp - Gram matrices prepared for arithmetic in single precision.
//
// Distances between fragments are small differences of large inner products when all fragments lie far from the
// neutral: with |f|^2 = 1e8 and distances of 1 nothing of them is left in a float. Distances do not change when every
// fragment moves by the same vector, and the Gram matrix about the mean fragment follows from the Gram matrix alone,
//   H[n,m] = <f_n - f, f_m - f> = G[n,m] - r_n - r_m + r,   r_n = mean_m G[n,m],   r = mean_n r_n,
// so it is formed in double, where the subtraction is harmless, and rounded to float only then. What rounding is left
// is relative to the spread of the fragments instead of their length.
#pragma once

#include <span>

#include "cl/layout.h"
#include "io/counts.hpp"
#include "search/gram_matrices.hpp"

namespace facezip::compress {

/// Fragments that a vector register holds; kernels pad the rows of a matrix to a multiple of it.
inline constexpr int kFragmentLanes = FACEZIP_VECTOR;

/// Whether the neutral, the zero fragment that stands for an empty cluster, is row N of the centred matrix.
enum class OriginRow { kWithout, kWith };

/// Writes the centred matrix H of `gram` (N x N), divided by its largest diagonal entry, to `out` (padded x padded
/// floats, row-major, zero beyond row and column N, or N + 1 with the origin). padded is a multiple of kFragmentLanes.
/// Returns that largest entry, to multiply results with; 0, and an all-zero matrix, when the fragments coincide: when
/// the spread is below 1e-12 of the largest |f_n|^2, where even the double has no more than rounding left.
double packCentredGram(const Eigen::Ref<const GramMatrices::Matrix>& gram, OriginRow origin, int padded,
                       std::span<float> out);

/// Rows that packCentredGram() needs for N expressions.
constexpr int paddedFragments(int expressions, OriginRow origin) {
  const int rows = expressions + (origin == OriginRow::kWith ? 1 : 0);
  return roundUp(rows, kFragmentLanes);
}

}  // namespace facezip::compress
