// blend.hpp - FaceZip's Eq. 8 in double, texel by texel, as docs/package_format.md says it: no tiles, no hoisting.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace reference {

struct Textures {
  int width, height, channels, differences, weight_scale;
  double full_scale;                        // of the samples: 255, 65535 or 1
  std::vector<double> neutral;              // [height][width][channels], raw samples
  std::vector<std::vector<double>> codes;   // C times [height][width][channels], whole numbers of 8 or 16 bits
  std::vector<std::vector<double>> scale;   // [C][channels], 1/255 of full scale per code
  std::vector<std::vector<double>> offset;  // [C][channels]
};

/// weights [cell_rows][cell_columns][C] at the position of texel (x, y), channel i: bilinear, clamped to the grid.
inline double sampleWeight(const std::vector<double>& weights, int cell_columns, int cell_rows, int channels, int i,
                           int x, int y, int s) {
  const double u = std::clamp((x + 0.5) / s - 0.5, 0.0, cell_columns - 1.0);
  const double v = std::clamp((y + 0.5) / s - 0.5, 0.0, cell_rows - 1.0);
  const int x0 = int(u), y0 = int(v);
  const int x1 = std::min(x0 + 1, cell_columns - 1), y1 = std::min(y0 + 1, cell_rows - 1);
  const auto at = [&](int cx, int cy) {
    return weights[(std::size_t(cy) * std::size_t(cell_columns) + std::size_t(cx)) * std::size_t(channels) +
                   std::size_t(i)];
  };
  const double top = at(x0, y0) * (1 - (u - x0)) + at(x1, y0) * (u - x0);
  const double bottom = at(x0, y1) * (1 - (u - x0)) + at(x1, y1) * (u - x0);
  return top * (1 - (v - y0)) + bottom * (v - y0);
}

/// [height][width][channels] samples before rounding and clamping.
inline std::vector<double> blendFrame(const Textures& t, const std::vector<double>& weights, int cell_columns,
                                      int cell_rows) {
  std::vector<double> frame = t.neutral;
  for (int y = 0; y < t.height; ++y) {
    for (int x = 0; x < t.width; ++x) {
      for (int i = 0; i < t.differences; ++i) {
        const double w = sampleWeight(weights, cell_columns, cell_rows, t.differences, i, x, y, t.weight_scale);
        for (int c = 0; c < t.channels; ++c) {
          const std::size_t sample =
              (std::size_t(y) * std::size_t(t.width) + std::size_t(x)) * std::size_t(t.channels) + std::size_t(c);
          const double d = t.scale[std::size_t(i)][std::size_t(c)] * t.codes[std::size_t(i)][sample] +
                           t.offset[std::size_t(i)][std::size_t(c)];
          frame[sample] += d * w * t.full_scale / 255.0;
        }
      }
    }
  }
  return frame;
}

}  // namespace reference
