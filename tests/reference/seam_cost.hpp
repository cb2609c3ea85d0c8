// seam_cost.hpp - Eq. 3 and 4 on texels, in double.
#pragma once

#include <cstddef>
#include <vector>

namespace reference {

/// Mean difference of a cluster's members, zero for an empty cluster.
inline std::vector<double> clusterMean(const std::vector<std::vector<double>>& differences,
                                       const std::vector<int>& labels, int cluster) {
  std::vector<double> mean(differences.front().size(), 0.0);
  double members = 0.0;
  for (std::size_t n = 0; n < differences.size(); ++n) members += labels[n] == cluster ? 1.0 : 0.0;
  for (std::size_t n = 0; n < differences.size(); ++n) {
    if (labels[n] != cluster) continue;
    for (std::size_t p = 0; p < mean.size(); ++p) mean[p] += differences[n][p] / members;
  }
  return mean;
}

/// |(D'_ak - D'_bl) M_k M_l|^2, D' the unmasked mean of a cluster.
inline double seamCost(const std::vector<std::vector<double>>& differences, const std::vector<double>& mask_k,
                       const std::vector<double>& mask_l, const std::vector<int>& labels_k,
                       const std::vector<int>& labels_l, int a, int b) {
  const std::vector<double> mean_a = clusterMean(differences, labels_k, a),
                            mean_b = clusterMean(differences, labels_l, b);
  double cost = 0.0;
  for (std::size_t p = 0; p < mean_a.size(); ++p) {
    const double seam = (mean_a[p] - mean_b[p]) * mask_k[p] * mask_l[p];
    cost += seam * seam;
  }
  return cost;
}

}  // namespace reference
