// mip_chain.hpp - one mip level from the one before, straight from its definition: texel (i, j) of m x k is the
// weighted mean over the area [i n / m, (i + 1) n / m) x [j l / k, (j + 1) l / k) of n x l texels.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace facezip::reference {

struct MipLevel {
  int width = 0, height = 0, channels = 0;
  std::vector<double> texels;   // height x width x channels
  std::vector<double> weights;  // height x width
};

/// How much of texel t lies in that part of n texels which becomes texel i of m.
inline double overlap(int n, int m, int i, int t) {
  const double size = static_cast<double>(n) / m;
  return std::max(0.0, std::min((i + 1) * size, t + 1.0) - std::max(i * size, static_cast<double>(t)));
}

inline MipLevel nextLevel(const MipLevel& from) {
  MipLevel to{std::max(1, from.width / 2), std::max(1, from.height / 2), from.channels, {}, {}};
  for (int j = 0; j < to.height; ++j) {
    for (int i = 0; i < to.width; ++i) {
      double area = 0.0, weight = 0.0;
      std::vector<double> plain(static_cast<std::size_t>(from.channels)), weighted(plain);
      for (int y = 0; y < from.height; ++y) {
        for (int x = 0; x < from.width; ++x) {
          const double share = overlap(from.width, to.width, i, x) * overlap(from.height, to.height, j, y);
          const auto p = static_cast<std::size_t>(y * from.width + x);
          area += share;
          weight += share * from.weights[p];
          for (std::size_t c = 0; c < plain.size(); ++c) {
            plain[c] += share * from.texels[p * plain.size() + c];
            weighted[c] += share * from.weights[p] * from.texels[p * plain.size() + c];
          }
        }
      }
      for (std::size_t c = 0; c < plain.size(); ++c)
        to.texels.push_back(weight > 0.0 ? weighted[c] / weight : plain[c] / area);
      to.weights.push_back(weight / area);
    }
  }
  return to;
}

}  // namespace facezip::reference
