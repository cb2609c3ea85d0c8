// resample.hpp - cubic convolution as Keys (1981) writes it, in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace facezip::reference {

/// Keys 1981, Eq. 15 with a = -1/2.
inline double cubicKernel(double s) {
  s = std::abs(s);
  if (s < 1.0) return 1.5 * s * s * s - 2.5 * s * s + 1.0;
  if (s < 2.0) return -0.5 * s * s * s + 2.5 * s * s - 4.0 * s + 2.0;
  return 0.0;
}

/// source  [height][width][channels]; x, y in texels, centres at integers
inline double resampled(const std::vector<double>& source, int width, int height, int channels, double x, double y,
                        int channel) {
  double sum = 0.0;
  for (int row = static_cast<int>(std::floor(y)) - 2; row <= static_cast<int>(std::floor(y)) + 3; ++row) {
    for (int column = static_cast<int>(std::floor(x)) - 2; column <= static_cast<int>(std::floor(x)) + 3; ++column) {
      const int r = std::clamp(row, 0, height - 1), c = std::clamp(column, 0, width - 1);
      const std::size_t at =
          (static_cast<std::size_t>(r) * static_cast<std::size_t>(width) + static_cast<std::size_t>(c)) *
              static_cast<std::size_t>(channels) +
          static_cast<std::size_t>(channel);
      sum += cubicKernel(row - y) * cubicKernel(column - x) * source[at];
    }
  }
  return sum;
}

}  // namespace facezip::reference
