// Reference for kernels/cl/difference_texture.cl: Eq. 5 of FaceZip, texel by texel in double.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace facezip::reference {

/// D_i(p, c) = sum over the masks of the tile of M_k(p) * sum_n coefficients[k][i][n] * Delta_n(p, c).
/// masks         index and weights [256] of each mask of the tile
/// coefficients  K x C x N
/// differences   [n][channel][256]
/// Returns [texture][channel][256].
inline std::vector<double> differenceTexture(const std::vector<std::pair<int, std::vector<double>>>& masks,
                                             const std::vector<float>& coefficients, int textures, int expressions,
                                             int channels, const std::vector<double>& differences) {
  std::vector<double> result;
  for (int i = 0; i < textures; ++i) {
    for (int c = 0; c < channels; ++c) {
      for (std::size_t p = 0; p < 256; ++p) {
        double value = 0.0;
        for (const auto& [k, weights] : masks) {
          double mean = 0.0;
          for (int n = 0; n < expressions; ++n) {
            const auto at = static_cast<std::size_t>((k * textures + i) * expressions + n);
            mean += static_cast<double>(coefficients[at]) *
                    differences[static_cast<std::size_t>(n * channels + c) * 256 + p];
          }
          value += weights[p] * mean;
        }
        result.push_back(value);
      }
    }
  }
  return result;
}

}  // namespace facezip::reference
