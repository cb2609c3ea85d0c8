// seam_cost.hpp - how badly two clusters fit where their masks overlap (FaceZip Eq. 3, 4).
#pragma once

#include <cstddef>
#include <vector>

#include "device/device_context.hpp"
#include "io/counts.hpp"
#include "search/gram_matrices.hpp"
#include "search/kmeans.hpp"

namespace facezip::compress {

/// A capture of the paper's size (475 pairs, N = 20) is one batch of 2 MB; 2000 pairs at N = 128 would be 166 MB, more
/// than a small device has to give.
inline constexpr std::size_t kSeamBatchBytes = std::size_t{32} << 20;

/// One C x C table per pair of overlapping masks.
struct SeamTables {
  int masks = 0;                ///< K
  int clusters = 0;             ///< C
  std::vector<MaskPair> pairs;  ///< rising by (k, l), k < l
  /// pairs x C x C, each >= 0, in units of (1/255)^2: entry [j][a][b] is |(D'_ak - D'_bl) M_k M_l|^2 for cluster a of
  /// mask k and cluster b of mask l, (k, l) = pairs[j]; the centre of an empty cluster is zero, that is the neutral.
  std::vector<double> values;

  double entry(int pair, int a, int b) const {
    const auto side = toSize(clusters);
    return values[(toSize(pair) * side + toSize(a)) * side + toSize(b)];
  }
};

/// Fills the tables from the pairs' Gram matrices. Errors are below 1e-5 of the largest squared distance of two
/// fragments under the same weights (tests/tolerances.hpp argues it); equal clusters cost exactly 0.
/// grams        as `clustering` was made from
/// batch_bytes  device memory for the matrices of the pairs that one launch takes; at least one pair's are held
/// Throws DeviceError.
SeamTables computeSeamTables(device::DeviceContext& context, const GramMatrices& grams, const Clustering& clustering,
                             std::size_t batch_bytes = kSeamBatchBytes);

/// Sizes and device buffers of one launch of kernels/cl/seam_cost.cl, which describes them.
struct SeamCostLaunch {
  int pairs = 0;
  int expressions = 0;
  int clusters = 0;
  cl::Buffer gram;
  cl::Buffer pair_masks;
  cl::Buffer labels;
  cl::Buffer tables;
};

/// Enqueues the kernel; the caller owns the buffers. For tests and benchmarks.
cl::Event launchSeamCost(device::DeviceContext& context, const SeamCostLaunch& launch);

}  // namespace facezip::compress
