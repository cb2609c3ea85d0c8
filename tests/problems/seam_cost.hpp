// seam_cost.hpp - problem of the step `seam_cost`.
#pragma once

#include <algorithm>

#include "problems/guarded_buffer.hpp"
#include "problems/hashed.hpp"
#include "reference/seam_cost.hpp"
#include "search/seam_cost.hpp"
#include "search_capture.hpp"

namespace facezip::test {

/// Labels drawn from the first `used` clusters, so that the others are empty.
inline compress::Clustering hashedClustering(int masks, int expressions, int clusters, int used, std::uint64_t seed) {
  Hashed hashed(seed);
  compress::Clustering clustering{
      .masks = masks, .expressions = expressions, .clusters = clusters, .labels = {}, .inertia = {}};
  for (int i = 0; i < masks * expressions; ++i) clustering.labels.push_back(hashed.below(used));
  return clustering;
}

/// Clusters of one mask.
inline std::vector<int> labelsOfMask(const compress::Clustering& clustering, int mask) {
  const auto first = clustering.labels.begin() + static_cast<std::ptrdiff_t>(mask) * clustering.expressions;
  return {first, first + clustering.expressions};
}

/// All of computeSeamTables(): centring in double, copies, kernel. Operations: an entry multiplies the rows of the
/// members of two clusters, 2 N / C of them, by N values.
struct SeamCostProblem {
  SeamCostProblem(device::DeviceContext& device, SearchCapture search_capture, compress::Clustering of_masks,
                  std::size_t most_batch_bytes = compress::kSeamBatchBytes)
      : context(device),
        capture(std::move(search_capture)),
        grams(gramsOf(capture)),
        clustering(std::move(of_masks)),
        batch_bytes(most_batch_bytes) {}

  void run() { tables = compress::computeSeamTables(context, grams, clustering, batch_bytes); }
  const compress::SeamTables& result() const { return tables; }
  double expected(int pair, int a, int b) const {
    const auto [k, l] = grams.slots.pairs[toSize(pair)];
    return reference::seamCost(capture.differences, capture.masks[toSize(k)], capture.masks[toSize(l)],
                               labelsOfMask(clustering, k), labelsOfMask(clustering, l), a, b);
  }
  /// Largest squared distance of a fragment of the pair, or of the neutral, from the fragments' mean: what errors scale
  /// with.
  double spread(int pair) const {
    const compress::GramMatrices::Matrix gram = grams.slot(grams.slots.pair(pair));
    const double mean_square = gram.mean();
    const Eigen::VectorXd to_mean = gram.diagonal() - 2.0 * gram.rowwise().mean();
    return std::max(mean_square, mean_square + to_mean.maxCoeff());
  }

  double flops() const {
    const double n = grams.expressions;
    const double clusters = clustering.clusters;
    return static_cast<double>(grams.slots.pairs.size()) * clusters * clusters * 2.0 * (2.0 * n / clusters) * n;
  }

  device::DeviceContext& context;
  SearchCapture capture;
  compress::GramMatrices grams;
  compress::Clustering clustering;
  std::size_t batch_bytes;
  compress::SeamTables tables;
};

}  // namespace facezip::test
