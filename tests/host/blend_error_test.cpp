#include "evaluate/blend_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <set>

namespace facezip {
namespace {
using evaluate::ErrorDistribution;

TEST(BlendError, WeightVectorsHaveOneToFiveExpressionsAndSumsUpToTwo) {
  const auto vectors = evaluate::randomWeightVectors(7, 400, 9);
  std::set<std::ptrdiff_t> counts;
  double sum_of_sums = 0.0;
  for (const std::vector<float>& beta : vectors) {
    ASSERT_EQ(beta.size(), 9u);
    counts.insert(std::count_if(beta.begin(), beta.end(), [](float b) { return b != 0.0f; }));
    const double sum = std::accumulate(beta.begin(), beta.end(), 0.0);
    EXPECT_GT(*std::max_element(beta.begin(), beta.end()), 0.0f);
    EXPECT_GE(*std::min_element(beta.begin(), beta.end()), 0.0f);
    EXPECT_LE(sum, 2.0 + 1e-6);
    sum_of_sums += sum;
  }
  EXPECT_EQ(counts, (std::set<std::ptrdiff_t>{1, 2, 3, 4, 5}));
  EXPECT_NEAR(sum_of_sums / 400.0, 1.0, 0.1);
}

TEST(BlendError, WeightVectorsFollowTheSeed) {
  const auto vectors = evaluate::randomWeightVectors(3, 8, 4);
  EXPECT_EQ(evaluate::randomWeightVectors(3, 8, 4), vectors);
  EXPECT_NE(evaluate::randomWeightVectors(4, 8, 4), vectors);
  const auto fewer = evaluate::randomWeightVectors(3, 2, 4);
  EXPECT_TRUE(std::equal(fewer.begin(), fewer.end(), vectors.begin()));
  EXPECT_TRUE(evaluate::randomWeightVectors(3, 0, 4).empty());
  for (const auto& beta : evaluate::randomWeightVectors(3, 8, 1)) EXPECT_GT(beta[0], 0.0f);
}

template <typename Sample>
std::vector<std::byte> bytesOf(const std::vector<Sample>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(Sample));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

TEST(BlendError, CapturedTexturesBlendLinearlyWithoutRounding) {
  const compress::BandShape shape{3, 1, 1, 2, image::SampleType::kUint8};
  const auto samples = bytesOf<std::uint8_t>({100, 50, 9, 110, 40, 9, 100, 70, 9});
  std::vector<float> out(3, -1.0f);
  evaluate::blendCaptured(samples, shape, std::vector<float>{0.25f, 2.0f}, std::vector<std::uint32_t>{0, 1}, out);
  EXPECT_FLOAT_EQ(out[0], 102.5f);
  EXPECT_FLOAT_EQ(out[1], 87.5f);
  EXPECT_EQ(out[2], -1.0f) << "not covered";
  const compress::BandShape wide{1, 1, 1, 1, image::SampleType::kUint16};
  const auto samples16 = bytesOf<std::uint16_t>({257 * 10, 257 * 30});
  std::vector<float> one(1);
  evaluate::blendCaptured(samples16, wide, std::vector<float>{0.5f}, std::vector<std::uint32_t>{0}, one);
  EXPECT_NEAR(one[0], 20.0f, 1e-4);
}

TEST(BlendError, SharesAreOfTheTriangleInequality) {
  std::vector<ErrorDistribution> expressions(2), blends(2);
  expressions[0].add(std::vector<float>{2.0f});
  expressions[1].add(std::vector<float>{1.0f});
  blends[0].add(std::vector<float>{1.0f});  // bound 0.5 * 2 + 1 * 1 = 2
  blends[1].add(std::vector<float>{3.0f});  // bound 2 * 2 = 4
  const std::vector<std::vector<float>> weights = {{0.5f, 1.0f}, {2.0f, 0.0f}};
  const BlendErrors errors = evaluate::summarizeBlendErrors(blends, weights, expressions);
  EXPECT_NEAR(errors.largest_share_of_bound, 0.75, 1e-12);
  EXPECT_NEAR(errors.rmse, std::sqrt(5.0), 1e-12);
}

}  // namespace
}  // namespace facezip
