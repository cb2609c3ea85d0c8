#include "refine/texture_encoding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace facezip::compress {
namespace {

class TextureEncodingOfBits : public testing::TestWithParam<int> {
 protected:
  int bits() const { return GetParam(); }
  float codes() const { return std::ldexp(1.0f, bits()) - 1.0f; }
};

TEST_P(TextureEncodingOfBits, HoldsAnyRangeWithinHalfAStepAndZeroExactly) {
  std::mt19937 random(7);
  std::normal_distribution<float> end(0.0f, 60.0f);
  std::uniform_real_distribution<float> magnitude(-12.0f, 6.0f);
  for (int i = 0; i < 20000; ++i) {
    const float unit = std::pow(10.0f, magnitude(random));
    const float a = end(random) * unit;
    const float b = end(random) * unit;
    const TextureRange range{std::min(a, b), std::max(a, b)};
    const TextureEncoding encoding = encodingFor(range, bits());
    ASSERT_GT(encoding.scale, 0.0f);
    const float zero = std::round(-encoding.offset / encoding.scale);
    ASSERT_GE(zero, 0.0f);
    ASSERT_LE(zero, codes());
    EXPECT_EQ(encoding.scale * zero + encoding.offset, 0.0f) << range.min << " " << range.max;
    EXPECT_EQ(std::fma(encoding.scale, zero, encoding.offset), 0.0f) << range.min << " " << range.max;
    EXPECT_EQ(static_cast<double>(encoding.scale) * static_cast<double>(zero), -static_cast<double>(encoding.offset));
    const float slack = 0.51f * encoding.scale;
    EXPECT_LE(encoding.offset, std::min(range.min, 0.0f) + slack);
    EXPECT_GE(encoding.offset + encoding.scale * codes(), std::max(range.max, 0.0f) - slack);
  }
}

TEST_P(TextureEncodingOfBits, SpendsNearlyAllCodesOnTheRange) {
  const TextureEncoding encoding = encodingFor({-31.7f, 90.1f}, bits());
  EXPECT_LE(encoding.scale, 121.8f / codes() * 1.01f);
}

TEST_P(TextureEncodingOfBits, GivesNothingForNoRange) {
  for (const TextureRange& range :
       {TextureRange{0.0f, 0.0f},
        TextureRange{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()},
        TextureRange{0.0f, std::numeric_limits<float>::denorm_min()}}) {
    const TextureEncoding encoding = encodingFor(range, bits());
    EXPECT_EQ(encoding.scale, 0.0f);
    EXPECT_EQ(encoding.offset, 0.0f);
  }
}

TEST_P(TextureEncodingOfBits, ReachesZeroWhereTheRangeDoesNot) {
  EXPECT_EQ(encodingFor({5.0f, 9.0f}, bits()).offset, 0.0f);
  const TextureEncoding below = encodingFor({-9.0f, -5.0f}, bits());
  // The scale is rounded up to few digits, so the last code may lie a little above.
  EXPECT_GE(below.offset + below.scale * codes(), 0.0f);
  EXPECT_LE(below.offset + below.scale * codes(), 0.01f * 9.0f);
}

INSTANTIATE_TEST_SUITE_P(Bits, TextureEncodingOfBits, testing::Values(8, 16));

}  // namespace
}  // namespace facezip::compress
