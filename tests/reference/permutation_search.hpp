// permutation_search.hpp - the lowest seam cost of all permutations, by trying them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

namespace reference {

/// Cost of masks k < l under their permutations: table(k, l)[a][b] summed over textures.
using SeamTable = std::function<double(int k, int l, int a, int b)>;

inline double permutationCost(const std::vector<std::vector<int>>& sigma, const SeamTable& table) {
  double cost = 0.0;
  for (std::size_t k = 0; k < sigma.size(); ++k) {
    for (std::size_t l = k + 1; l < sigma.size(); ++l) {
      for (std::size_t i = 0; i < sigma[k].size(); ++i) {
        cost += table(static_cast<int>(k), static_cast<int>(l), sigma[k][i], sigma[l][i]);
      }
    }
  }
  return cost;
}

/// Minimum over all C!^(K-1) permutations; the first mask stands still, for renumbering the textures changes nothing.
inline double lowestPermutationCost(int masks, int clusters, const SeamTable& table) {
  std::vector<int> sorted(static_cast<std::size_t>(clusters));
  std::iota(sorted.begin(), sorted.end(), 0);
  std::vector<std::vector<int>> sigma(static_cast<std::size_t>(masks), sorted);
  double lowest = std::numeric_limits<double>::infinity();
  for (;;) {
    lowest = std::min(lowest, permutationCost(sigma, table));
    std::size_t k = 1;
    while (k < sigma.size() && !std::next_permutation(sigma[k].begin(), sigma[k].end())) ++k;
    if (k >= sigma.size()) return lowest;
  }
}

}  // namespace reference
