#include "register/hole_filling.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

#include "io/counts.hpp"

namespace facezip::registration {
namespace {

/// A picture of sums of known values, and how much of each texel is known.
struct Level {
  int width = 0;
  int height = 0;
  std::vector<float> values;  ///< means of what is known
  std::vector<float> weights;

  std::size_t at(int x, int y) const { return toSize(y, width) + toSize(x); }
};

Level halved(const Level& fine, int channels) {
  Level coarse{divideUp(fine.width, 2), divideUp(fine.height, 2), {}, {}};
  coarse.weights.resize(toSize(coarse.width, coarse.height));
  coarse.values.resize(coarse.weights.size() * toSize(channels));
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) {
      const std::size_t to = coarse.at(x, y);
      float* const values = &coarse.values[to * toSize(channels)];
      float sum = 0.0f;
      for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j) {
        for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i) {
          const std::size_t from = fine.at(i, j);
          sum += fine.weights[from];
          for (int c = 0; c < channels; ++c) {
            values[c] += fine.weights[from] * fine.values[from * toSize(channels) + toSize(c)];
          }
        }
      }
      if (sum > 0.0f) std::for_each(values, values + channels, [sum](float& v) { v /= sum; });
      coarse.weights[to] = std::min(1.0f, sum);
    }
  }
  return coarse;
}

/// What of a texel is not known comes from the coarser level, bilinearly.
void fillFrom(const Level& coarse, int channels, Level& fine) {
  for (int y = 0; y < fine.height; ++y) {
    const int near_y = y / 2, far_y = std::clamp(near_y + (y % 2 == 0 ? -1 : 1), 0, coarse.height - 1);
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t to = fine.at(x, y);
      const float weight = fine.weights[to];
      if (weight >= 1.0f) continue;
      const int near_x = x / 2, far_x = std::clamp(near_x + (x % 2 == 0 ? -1 : 1), 0, coarse.width - 1);
      for (int c = 0; c < channels; ++c) {
        const auto value = [&](int i, int j) { return coarse.values[coarse.at(i, j) * toSize(channels) + toSize(c)]; };
        const float above = 0.75f * value(near_x, near_y) + 0.25f * value(far_x, near_y);
        const float below = 0.75f * value(near_x, far_y) + 0.25f * value(far_x, far_y);
        float& out = fine.values[to * toSize(channels) + toSize(c)];
        out = weight * out + (1.0f - weight) * (0.75f * above + 0.25f * below);
      }
    }
  }
}

}  // namespace

void fillHoles(std::span<float> values, int channels, int width, int height, std::span<const std::uint8_t> known) {
  assert(values.size() == toSize(width, height, channels) && known.size() == toSize(width, height));
  std::vector<Level> levels(1, {width, height, {values.begin(), values.end()}, {}});
  for (const std::uint8_t seen : known) levels[0].weights.push_back(seen != 0 ? 1.0f : 0.0f);
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(halved(levels.back(), channels));
  if (levels.back().weights[0] == 0.0f) {
    std::fill(values.begin(), values.end(), 0.0f);
    return;
  }
  for (std::size_t level = levels.size() - 1; level > 0; --level) fillFrom(levels[level], channels, levels[level - 1]);
  std::copy(levels[0].values.begin(), levels[0].values.end(), values.begin());
}

}  // namespace facezip::registration
