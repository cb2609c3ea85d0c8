// Reference for kernels/cl/bc4_encode.cl and a bound for bc7_encode.cl, in double: what the best of all BC4 blocks errs
// by, and what a plain search finds for BC7's mode 6.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace facezip::reference {

/// Least sum of weight * (texel - decoded)^2 over all BC4 blocks: every pair of ends, of both kinds.
inline double bestBc4Error(const std::array<double, 16>& texels, const std::array<double, 16>& weights) {
  double least = std::numeric_limits<double>::max();
  for (int a = 0; a < 256; ++a) {
    for (int b = 0; b < 256; ++b) {
      std::vector<double> values;
      const int steps = a > b ? 7 : 5;
      for (int i = 0; i <= steps; ++i) values.push_back(((steps - i) * a + i * b) / static_cast<double>(steps));
      if (steps == 5) values.insert(values.end(), {0.0, 255.0});
      double error = 0.0;
      for (std::size_t t = 0; t < 16 && error < least; ++t) {
        double nearest = std::numeric_limits<double>::max();
        for (const double value : values) nearest = std::min(nearest, (texels[t] - value) * (texels[t] - value));
        error += weights[t] * nearest;
      }
      least = std::min(least, error);
    }
  }
  return least;
}

/// Error of a mode 6 block of three channels: the line from corner to corner of the texels' box, along the diagonal
/// that fits best, and along the two texels that are farthest apart, with every p-bit; indices by trying all.
inline double plainMode6Error(const std::array<std::array<double, 3>, 16>& texels) {
  const auto coded = [](double value, int p) {
    const double code = std::clamp(std::round((value - p) / 2.0), 0.0, 127.0);
    return 2.0 * code + p;
  };
  const auto errorOf = [&](const std::array<double, 3>& first, const std::array<double, 3>& second) {
    double least = std::numeric_limits<double>::max();
    for (int p = 0; p < 4; ++p) {
      double error = 0.0;
      for (const auto& texel : texels) {
        double nearest = std::numeric_limits<double>::max();
        for (int i = 0; i < 16; ++i) {
          const double weight = std::round(i * 64.0 / 15.0);
          double sum = 0.0;
          for (std::size_t c = 0; c < 3; ++c) {
            const double value =
                std::floor(((64.0 - weight) * coded(first[c], p % 2) + weight * coded(second[c], p / 2) + 32.0) / 64.0);
            sum += (texel[c] - value) * (texel[c] - value);
          }
          nearest = std::min(nearest, sum);
        }
        error += nearest;
      }
      least = std::min(least, error);
    }
    return least;
  };
  std::array<double, 3> low = texels[0];
  std::array<double, 3> high = texels[0];
  double apart = -1.0;
  std::array<double, 3> from{}, to{};
  for (const auto& a : texels) {
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], a[c]);
      high[c] = std::max(high[c], a[c]);
    }
    for (const auto& b : texels) {
      double distance = 0.0;
      for (std::size_t c = 0; c < 3; ++c) distance += (a[c] - b[c]) * (a[c] - b[c]);
      if (distance > apart) {
        apart = distance;
        from = a;
        to = b;
      }
    }
  }
  double least = errorOf(from, to);
  for (int corner = 0; corner < 4; ++corner) {
    std::array<double, 3> first = low;
    std::array<double, 3> second = high;
    if (corner % 2 == 1) std::swap(first[1], second[1]);
    if (corner / 2 == 1) std::swap(first[2], second[2]);
    least = std::min(least, errorOf(first, second));
  }
  return least;
}

}  // namespace facezip::reference
