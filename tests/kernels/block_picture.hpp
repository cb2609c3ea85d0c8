// block_picture.hpp - texels for tests of block encoders: smooth, grainy, edges of several colours, flat, extremes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace facezip::test {

struct BlockPicture {
  int width = 0;
  int rows = 0;
  int channels = 0;
  std::vector<float> texels;  // code units, fractional

  std::size_t at(int x, int y, int c) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
               static_cast<std::size_t>(channels) +
           static_cast<std::size_t>(c);
  }
};

/// Skin-like tones with grain, crossed by edges; stripes of blocks that are flat, and of noise that reaches beyond 0
/// and 255.
inline BlockPicture blockPicture(int width, int rows, int channels, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<float> grain(0.0f, 3.0f);
  std::uniform_real_distribution<float> anything(-10.0f, 265.0f);
  BlockPicture picture{width, rows, channels, {}};
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = static_cast<float>(x) * 0.11f;
      const float v = static_cast<float>(y) * 0.07f;
      const bool inside = std::sin(u) + std::cos(1.7f * v) > 0.4f;
      const float shade = 20.0f * std::sin(0.9f * u + v);
      for (int c = 0; c < channels; ++c) {
        const float tone = inside ? 190.0f - 35.0f * static_cast<float>(c) : 90.0f + 30.0f * static_cast<float>(c % 2);
        float value = tone + shade + grain(random);
        if (y / 4 % 8 == 5) value = 77.25f + static_cast<float>(c) * 40.5f;
        if (y / 4 % 8 == 7) value = anything(random);
        picture.texels.push_back(value);
      }
    }
  }
  return picture;
}

}  // namespace facezip::test
