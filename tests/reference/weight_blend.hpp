// weight_blend.hpp - the bracket of FaceZip's Eq. 8 in double, as it is written: independent of facezip's code and
// layouts.
#pragma once

#include <cstddef>
#include <vector>

namespace reference {

struct WeightMaps {
  int columns, rows, channels, expressions;
  std::vector<unsigned char> codes;   // [N][rows][columns][C]
  std::vector<double> scale, offset;  // [C]
};

/// [rows][columns][C]; gain [rows][columns], empty for 1
inline std::vector<double> blendWeights(const WeightMaps& maps, const std::vector<float>& beta,
                                        const std::vector<float>& gain = {}) {
  const std::size_t size = std::size_t(maps.columns) * std::size_t(maps.rows) * std::size_t(maps.channels);
  std::vector<double> sum(size, 0.0);
  for (std::size_t n = 0; n < std::size_t(maps.expressions); ++n) {
    for (std::size_t q = 0; q < size; ++q) {
      const std::size_t i = q % std::size_t(maps.channels);
      sum[q] += double(beta[n]) * (maps.scale[i] * maps.codes[n * size + q] + maps.offset[i]);
    }
  }
  for (std::size_t q = 0; q < size && !gain.empty(); ++q) sum[q] *= double(gain[q / std::size_t(maps.channels)]);
  return sum;
}

}  // namespace reference
