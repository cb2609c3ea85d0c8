// photograph_like.hpp - a picture with what photographs have: detail of every size that gets weaker with it, channels
// that mostly go together, objects with edges, and the grain of a sensor. From hashes: the same everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace facezip::test {

/// 0 to 1.
inline float hashed(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ seed * 0xc2b2ae3du;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  return static_cast<float>((h ^ h >> 15) >> 8) * 0x1p-24f;
}

/// Values at the corners of cells of `size` texels, -1 to 1, smooth between them.
inline float cellNoise(int x, int y, int size, std::uint32_t seed) {
  const auto column = static_cast<std::uint32_t>(x / size), row = static_cast<std::uint32_t>(y / size);
  const auto eased = [size](int at) {
    const float t = (static_cast<float>(at % size) + 0.5f) / static_cast<float>(size);
    return t * t * (3.0f - 2.0f * t);
  };
  const float u = eased(x), v = eased(y);
  const float above = std::lerp(hashed(column, row, seed), hashed(column + 1, row, seed), u);
  const float below = std::lerp(hashed(column, row + 1, seed), hashed(column + 1, row + 1, seed), u);
  return 2.0f * std::lerp(above, below, v) - 1.0f;
}

/// width x height x 3, 0 to 255, red first.
inline std::vector<std::uint8_t> photographLike(int width, int height, std::uint32_t seed = 1) {
  std::vector<std::uint8_t> texels;
  texels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool object = cellNoise(x, y, 90, seed + 50) + 0.4f * cellNoise(x, y, 23, seed + 51) > 0.25f;
      float light = object ? 90.0f : 150.0f;
      for (int size = 128, octave = 0; size > 1; size /= 2, ++octave) {
        light += 22.0f * std::pow(0.72f, static_cast<float>(octave)) *
                 cellNoise(x, y, size, seed + static_cast<std::uint32_t>(octave));
      }
      for (std::uint32_t c = 0; c < 3; ++c) {
        const float tint = (object ? 20.0f : -15.0f) * (static_cast<float>(c) - 1.0f);
        const float own = 9.0f * cellNoise(x, y, 40, seed + 10 + c) + 3.0f * cellNoise(x, y, 5, seed + 20 + c);
        const float grain =
            3.0f * (hashed(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed + 30 + c) - 0.5f);
        texels.push_back(static_cast<std::uint8_t>(std::clamp(light + tint + own + grain, 0.0f, 255.0f) + 0.5f));
      }
    }
  }
  return texels;
}

}  // namespace facezip::test
