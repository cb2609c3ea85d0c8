// weight_map.hpp - Eq. 6 at one cell, with alpha formed as the paper defines it, in double.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace reference {

/// sum_k alpha_ink M_k: `masks` holds (k, M_k) of the cell, alpha_ink = 1 when texture_of[k][n] is i.
inline double weight(const std::vector<std::pair<int, double>>& masks, const std::vector<std::vector<int>>& texture_of,
                     int i, int n) {
  double sum = 0.0;
  for (const auto& [k, value] : masks) {
    const double alpha = texture_of[static_cast<std::size_t>(k)][static_cast<std::size_t>(n)] == i ? 1.0 : 0.0;
    sum += alpha * value;
  }
  return sum;
}

}  // namespace reference
