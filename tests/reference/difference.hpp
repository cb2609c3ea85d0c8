// Reference for kernels/cl/difference.cl: differences to the neutral, tile by tile, in double.
#pragma once

#include <cstddef>
#include <vector>

namespace facezip::reference {

/// samples  [1 + N][rows][width][channels], as doubles; image 0 is the neutral
/// tiles    column and row of each tile, two ints a tile
/// fades    [tile][256], or empty
/// Returns [tile][n][channel][256] in units of 1/255; `unit` is the factor from a sample.
inline std::vector<double> differences(const std::vector<double>& samples, const std::vector<int>& tiles, int width,
                                       int rows, int channels, int expressions, double unit,
                                       const std::vector<float>& fades = {}) {
  std::vector<double> result;
  const auto sample = [&](int image, int y, int x, int c) {
    const std::size_t row =
        static_cast<std::size_t>(image) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(y);
    const std::size_t texel = row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    return samples[texel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)];
  };
  for (std::size_t t = 0; t < tiles.size(); t += 2) {
    for (int n = 0; n < expressions; ++n) {
      for (int c = 0; c < channels; ++c) {
        for (int texel = 0; texel < 256; ++texel) {
          const int x = tiles[t] * 16 + texel % 16;
          const int y = tiles[t + 1] * 16 + texel / 16;
          const bool inside = x < width && y < rows;
          const double fade =
              fades.empty() ? 1.0 : static_cast<double>(fades[t / 2 * 256 + static_cast<std::size_t>(texel)]);
          result.push_back(inside ? (sample(n + 1, y, x, c) - sample(0, y, x, c)) * unit * fade : 0.0);
        }
      }
    }
  }
  return result;
}

}  // namespace facezip::reference
