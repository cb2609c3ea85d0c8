#include "blocks/mip_chain.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "blocks/block_texture.hpp"
#include "reference/mip_chain.hpp"
#include "tolerances.hpp"

namespace facezip::blocks {
namespace {

struct Rows {
  std::vector<float> texels, weights;
  int next = 0;
};
using Levels = std::map<int, Rows>;

Levels chainOf(int width, int height, int channels, std::span<const float> texels, std::span<const float> weights,
               int band) {
  Levels levels;
  MipChain chain(width, height, channels, mostLevels(width, height),
                 [&](int level, int y, std::span<const float> row, std::span<const float> row_weights) {
                   Rows& rows = levels[level];
                   EXPECT_EQ(y, rows.next++) << "level " << level;
                   EXPECT_EQ(row.size(), row_weights.size() * static_cast<std::size_t>(channels));
                   EXPECT_EQ(row_weights.size(), static_cast<std::size_t>(levelSide(width, level)));
                   rows.texels.insert(rows.texels.end(), row.begin(), row.end());
                   rows.weights.insert(rows.weights.end(), row_weights.begin(), row_weights.end());
                 });
  for (int y = 0; y < height; y += band) {
    const auto rows = static_cast<std::size_t>(std::min(band, height - y));
    const auto columns = static_cast<std::size_t>(width);
    const std::size_t first = static_cast<std::size_t>(y) * columns;
    const auto c = static_cast<std::size_t>(channels);
    chain.push(texels.subspan(first * c, rows * columns * c),
               weights.empty() ? weights : weights.subspan(first, rows * columns));
  }
  return levels;
}

std::vector<float> anyNumbers(std::size_t count, float most, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(0.0f, most);
  std::vector<float> numbers(count);
  for (float& value : numbers) value = number(random);
  return numbers;
}

TEST(MipChain, EveryLevelIsTheMeanOverItsArea) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {2, 2}, {3, 3}, {16, 8}, {7, 5}, {1, 9}, {13, 1}, {37, 22}, {31, 63}}) {
    for (const int channels : {1, 3, 4}) {
      const auto count = static_cast<std::size_t>(width * height);
      const std::vector<float> texels = anyNumbers(count * static_cast<std::size_t>(channels), 255.0f, 1);
      for (const bool weighted : {false, true}) {
        std::vector<float> weights = weighted ? anyNumbers(count, 1.0f, 2) : std::vector<float>();
        for (float& weight : weights) weight = std::max(0.0f, 2.0f * weight - 1.0f);
        const Levels levels = chainOf(width, height, channels, texels, weights, 5);
        reference::MipLevel expected{
            width, height, channels, {texels.begin(), texels.end()}, std::vector<double>(count, 1.0)};
        if (weighted) expected.weights.assign(weights.begin(), weights.end());
        EXPECT_EQ(levels.size(), static_cast<std::size_t>(mostLevels(width, height) - 1));
        for (const auto& [level, rows] : levels) {
          expected = reference::nextLevel(expected);
          ASSERT_EQ(rows.texels.size(), expected.texels.size());
          for (std::size_t i = 0; i < rows.texels.size(); ++i) {
            ASSERT_NEAR(static_cast<double>(rows.texels[i]), expected.texels[i], test::kMipTexel)
                << width << " x " << height << ", level " << level;
          }
          for (std::size_t i = 0; i < rows.weights.size(); ++i) {
            ASSERT_NEAR(static_cast<double>(rows.weights[i]), expected.weights[i], 1e-6);
          }
        }
      }
    }
  }
}

TEST(MipChain, UncoveredTexelsDoNotBleed) {
  // Skin of 100 on the left, nothing on the right, where texels are 255.
  const int side = 32;
  std::vector<float> texels, weights;
  for (int p = 0; p < side * side; ++p) {
    const bool covered = p % side < 11;
    texels.push_back(covered ? 100.0f : 255.0f);
    weights.push_back(covered ? 1.0f : 0.0f);
  }
  int partly = 0;
  for (const auto& [level, rows] : chainOf(side, side, 1, texels, weights, 32)) {
    for (std::size_t i = 0; i < rows.texels.size(); ++i) {
      EXPECT_EQ(rows.texels[i], rows.weights[i] > 0.0f ? 100.0f : 255.0f) << "level " << level;
      partly += rows.weights[i] > 0.0f && rows.weights[i] < 1.0f;
    }
  }
  EXPECT_GT(partly, 10);
}

TEST(MipChain, BandsMakeNoDifference) {
  const std::vector<float> texels = anyNumbers(45 * 38 * 2, 255.0f, 3);
  const std::vector<float> weights = anyNumbers(45 * 38, 1.0f, 4);
  const Levels whole = chainOf(45, 38, 2, texels, weights, 38);
  for (const int band : {1, 7, 16}) {
    for (const auto& [level, rows] : chainOf(45, 38, 2, texels, weights, band)) {
      EXPECT_EQ(rows.texels, whole.at(level).texels);
      EXPECT_EQ(rows.weights, whole.at(level).weights);
    }
  }
}

TEST(MipChain, ALevelOfABlendIsTheBlendOfTheLevels) {
  const int width = 21, height = 34;
  const std::vector<float> a = anyNumbers(21 * 34, 255.0f, 5), b = anyNumbers(21 * 34, 255.0f, 6);
  std::vector<float> blend;
  for (std::size_t i = 0; i < a.size(); ++i) blend.push_back(a[i] + 0.3f * b[i]);
  const Levels of_a = chainOf(width, height, 1, a, {}, 34), of_b = chainOf(width, height, 1, b, {}, 34);
  for (const auto& [level, rows] : chainOf(width, height, 1, blend, {}, 34)) {
    for (std::size_t i = 0; i < rows.texels.size(); ++i) {
      EXPECT_NEAR(rows.texels[i], of_a.at(level).texels[i] + 0.3f * of_b.at(level).texels[i], 2e-4f);
    }
  }
}

TEST(MipChain, FewerLevelsWhereFewerAreAskedFor) {
  int most = 0;
  MipChain chain(64, 64, 1, 3, [&](int level, int, auto, auto) { most = std::max(most, level); });
  chain.push(std::vector<float>(64 * 64, 1.0f));
  EXPECT_EQ(most, 2);
  MipChain none(64, 64, 1, 1, [](int, int, auto, auto) { FAIL(); });
  none.push(std::vector<float>(64 * 64, 1.0f));
}

}  // namespace
}  // namespace facezip::blocks
