#include "evaluate/texel_errors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bands/covered_texels.hpp"
#include "small_capture.hpp"

namespace facezip {
namespace {

TEST(TexelErrors, AreRootMeanSquaresOverChannels) {
  const std::vector<float> decoded = {3.0f, 4.0f, 10.0f, 10.0f, 0.0f, 0.0f};
  const std::vector<float> captured = {0.0f, 0.0f, 10.0f, 10.0f, 1.0f, -7.0f};
  const std::vector<std::uint32_t> texels = {0, 2};
  std::vector<float> errors(2);
  evaluate::texelErrors(decoded, captured, 2, texels, errors);
  EXPECT_FLOAT_EQ(errors[0], std::sqrt(12.5f));
  EXPECT_FLOAT_EQ(errors[1], 5.0f);
}

TEST(TexelErrors, SummaryHasPeakSignalToNoiseOf255) {
  evaluate::ErrorDistribution errors;
  errors.add(std::vector<float>{2.55f});
  EXPECT_NEAR(evaluate::summarizeTexelErrors(errors).psnr, 40.0, 1e-4);
  evaluate::ErrorDistribution none;
  none.add(std::vector<float>{0.0f});
  EXPECT_TRUE(std::isinf(evaluate::summarizeTexelErrors(none).psnr));
}

/// The covered texels of four tiles, of which one is not listed, at the edge of a band of 21 x 18 texels.
TEST(CoveredTexels, AreInsideTheBandOfAnyWeightAndInOrder) {
  const compress::BandShape shape{21, 18, 3, 1, image::SampleType::kUint8};
  compress::TileMasks tiles;
  std::vector<std::uint32_t> expected;
  for (const auto& [tile_x, tile_y] : {std::pair{0, 0}, std::pair{1, 0}, std::pair{0, 1}}) {
    tiles.tiles.push_back({tile_x, tile_y});
    for (int p = 0; p < 256; ++p) {
      const int x = tile_x * 16 + p % 16;
      const int y = tile_y * 16 + p / 16;
      const float weight = (x + y) % 3 == 0 ? 0.0f : (x + y) % 3 == 1 ? 1.0f : 0.01f;  // a fraction counts too
      tiles.texel_weights.push_back(weight);
      if (weight > 0.0f && x < 21 && y < 18) expected.push_back(static_cast<std::uint32_t>(y * 21 + x));
    }
  }
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(compress::coveredTexels(shape, tiles), expected);
}

class Values : public testing::TestWithParam<image::SampleType> {};

TEST_P(Values, AreInUnitsOf255) {
  const auto image = test::makeImage({9, 7, 3, GetParam()}, [](int x, int y, int c) { return 10.0 + x + 3 * y + c; });
  std::vector<float> values(9 * 7 * 3);
  compress::toValues(image.samples, GetParam(), values);
  for (int i = 0; i < 9 * 7 * 3; ++i) {
    const int texel = i / 3;
    EXPECT_NEAR(values[static_cast<std::size_t>(i)], 10.0 + texel % 9 + 3 * (texel / 9) + i % 3, 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Types, Values,
                         testing::Values(image::SampleType::kUint8, image::SampleType::kUint16,
                                         image::SampleType::kFloat32));

}  // namespace
}  // namespace facezip
