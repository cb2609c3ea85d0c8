#include "evaluate/squared_error.hpp"

#include <gtest/gtest.h>

#include "small_capture.hpp"

namespace facezip {
namespace {

class SquaredError : public testing::TestWithParam<image::SampleType> {};

TEST_P(SquaredError, SumsOverCoveredTexelsInUnitsOf255) {
  const compress::BandShape shape{21, 18, 3, 1, GetParam()};
  const image::ImageShape image_shape{21, 18, 3, GetParam()};
  const auto a = test::makeImage(image_shape, [](int x, int y, int c) { return 10.0 + x + y + c; });
  const auto b = test::makeImage(image_shape, [](int x, int y, int c) {
    return 10.0 + x + y + c + (x == 20 ? 3.0 : y == 17 ? 2.0 : 0.0);
  });
  compress::TileMasks tiles;
  double expected = 0.0;
  for (const auto& [tile_x, tile_y] :
       {std::pair{0, 0}, std::pair{1, 0}, std::pair{0, 1}}) {  // the fourth tile is not covered
    tiles.tiles.push_back({tile_x, tile_y});
    for (int p = 0; p < 256; ++p) {
      const int x = tile_x * 16 + p % 16;
      const int y = tile_y * 16 + p / 16;
      const bool covered = (x + y) % 2 == 0;
      tiles.texel_weights.push_back(covered ? 1.0f : 0.0f);
      if (covered && x < 21 && y < 18) expected += 3.0 * (x == 20 ? 9.0 : y == 17 ? 4.0 : 0.0);
    }
  }
  EXPECT_GT(expected, 0.0);
  EXPECT_NEAR(evaluate::squaredError(a.samples, b.samples, shape, tiles), expected, 1e-3 * expected);
}

INSTANTIATE_TEST_SUITE_P(Types, SquaredError,
                         testing::Values(image::SampleType::kUint8, image::SampleType::kUint16,
                                         image::SampleType::kFloat32));

}  // namespace
}  // namespace facezip
