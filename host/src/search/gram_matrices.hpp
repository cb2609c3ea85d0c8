// gram_matrices.hpp - inner products of the expressions' differences under each mask and pair of masks.
// Fragment distances (Eq. 2), k-means and seam costs (Eq. 3, 4) are all sums over these, so texels are read once.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "io/counts.hpp"
#include "raster/tiles.hpp"

namespace facezip::compress {

using raster::MaskPair;

/// Which weighting each Gram matrix has. Slot 0 weighs all covered texels alike (for PCA and error shares), slot 1 + k
/// by M_k^2, slot 1 + K + j by (M_k M_l)^2 of pair j.
struct GramSlots {
  int masks = 0;                ///< K
  std::vector<MaskPair> pairs;  ///< rising by (k, l)

  int count() const { return 1 + masks + static_cast<int>(pairs.size()); }
  int whole() const { return 0; }
  int mask(int k) const { return 1 + k; }
  int pair(int j) const { return 1 + masks + j; }
  /// Of GramMatrices::values for N expressions.
  std::size_t bytes(int expressions) const {
    const auto n = toSize(expressions);
    return toSize(count()) * n * n * sizeof(double);
  }
};

/// One symmetric N x N matrix per slot, in units of (1/255)^2, summed over covered texels, channels and maps.
struct GramMatrices {
  GramSlots slots;
  int expressions = 0;         ///< N
  std::vector<double> values;  ///< slots.count() x N x N

  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<const Matrix> slot(int index) const {
    return {values.data() + toSize(index, expressions) * toSize(expressions), expressions, expressions};
  }
};

}  // namespace facezip::compress
