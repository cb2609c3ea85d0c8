// Reference for kernels/cl/gram*.cl: weighted Gram matrices straight from their definition, in double.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace facezip::reference {

/// One tile: dense differences [n][channel][256], texel weights [256] and masks with their weights [256] each.
struct GramTile {
  std::vector<double> differences;
  std::vector<double> texel_weights;
  std::vector<std::pair<int, std::vector<double>>> masks;
};

/// Mask k of a tile at texel p; 0 where the tile does not have it.
inline double maskAt(const GramTile& tile, int k, std::size_t p) {
  for (const auto& [index, weights] : tile.masks) {
    if (index == k) return weights[p];
  }
  return 0.0;
}

/// G[n, m] = sum_p texel_weight(p) w(p) sum_c Delta_n Delta_m, w = 1 (k = l = -1), M_k^2 (l = -1) or (M_k M_l)^2;
/// row-major N x N.
inline std::vector<double> gram(const std::vector<GramTile>& tiles, int expressions, int channels, int k, int l) {
  const auto n_count = static_cast<std::size_t>(expressions);
  std::vector<double> result(n_count * n_count, 0.0);
  for (const GramTile& tile : tiles) {
    for (std::size_t p = 0; p < 256; ++p) {
      double mask = 1.0;
      if (k >= 0) mask *= maskAt(tile, k, p);
      if (l >= 0) mask *= maskAt(tile, l, p);
      const double weight = tile.texel_weights[p] * mask * mask;
      if (weight == 0.0) continue;
      for (std::size_t n = 0; n < n_count; ++n) {
        for (std::size_t m = 0; m < n_count; ++m) {
          double dot = 0.0;
          for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
            const std::size_t stride = static_cast<std::size_t>(channels);
            dot += tile.differences[(n * stride + c) * 256 + p] * tile.differences[(m * stride + c) * 256 + p];
          }
          result[n * n_count + m] += weight * dot;
        }
      }
    }
  }
  return result;
}

}  // namespace facezip::reference
