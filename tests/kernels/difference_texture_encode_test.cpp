#include "problems/difference_texture_encode.hpp"

#include <gtest/gtest.h>

#include <random>
#include <tuple>

#include "difference_texture_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using compress::TextureEncoder;
using compress::TextureEncoding;

class DifferenceTextureEncode : public testing::TestWithParam<std::tuple<TextureSizes, int>> {
 protected:
  void SetUp() override {
    if (isTooLarge(std::get<0>(GetParam()))) GTEST_SKIP() << "small sizes only";
  }
};

TEST_P(DifferenceTextureEncode, GivesTheNearestCodeOfEveryTexelOfTheBand) {
  const auto& [sizes, bits] = GetParam();
  auto problem = textureProblem<DifferenceTextureEncodeProblem>(sizes, bits);
  problem.run();
  const std::vector<double> codes = problem.result();
  const std::vector<double> positions = problem.expectedPositions();
  ASSERT_EQ(codes.size(), positions.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    // Half upwards, with room for the last bits of float32 at the half itself.
    ASSERT_GE(codes[i], positions[i] - 0.5 - kEncodeTie * problem.largestCode()) << "at " << i;
    ASSERT_LE(codes[i], positions[i] + 0.5 + kEncodeTie * problem.largestCode()) << "at " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceTextureEncode,
                         testing::Combine(testing::ValuesIn(kTextureSizes), testing::Values(8, 16)));

/// The codes of a tile of one texture.
std::vector<double> encodeTile(HalfTile& tile, const TextureEncoding& encoding, int bits) {
  std::vector<std::byte> codes(toSize(kTileTexels * bits / 8));
  TextureEncoder(testDevice(), 1)
      .encode(tile.tiles, tile.shape, tile.textures.textures(), std::vector<TextureEncoding>{encoding}, bits, codes);
  return codeNumbers(codes, bits);
}

TEST(DifferenceTextureEncode, HalvesRoundUpwards) {
  HalfTile tile;  // scale 2 makes 0.5 of 1
  std::vector<double> expected(kTileTexels, 0.0);
  std::fill_n(expected.begin(), kTileTexels / 2, 1.0);
  for (const int bits : {8, 16}) EXPECT_EQ(encodeTile(tile, {2.0f, 0.0f}, bits), expected) << bits;
}

/// Texels outside the masks must decode to 0, not nearly: with the encodings that compress chooses, at their largest
/// codes.
TEST(DifferenceTextureEncode, ZeroHasItsCodeInEveryEncoding) {
  HalfTile tile;  // below its middle there is no mask
  Hashed hashed(3);
  for (int round = 0; round < 100; ++round) {
    const float low = -hashed.between(0.01f, 200.0f);
    const float high = round % 2 == 0 ? 0.0f : hashed.between(0.01f, 200.0f);
    for (const int bits : {8, 16}) {
      const TextureEncoding encoding = compress::encodingFor({low, high}, bits);
      const double zero = static_cast<double>(-encoding.offset / encoding.scale);
      ASSERT_EQ(encodeTile(tile, encoding, bits).back(), zero) << low << " " << high << " " << bits;
    }
  }
}

TEST(DifferenceTextureEncode, BandWithoutTilesIsTheCodeOfZero) {
  NoTiles none;
  for (const int bits : {8, 16}) {
    std::vector<std::byte> codes(toSize(33 * 5 * 2 * bits / 8));
    TextureEncoder(testDevice(), 1)
        .encode(none.tiles, none.shape, none.textures.textures(),
                std::vector<TextureEncoding>{{1.0f, -128.0f}, {2.0f, -20.0f}}, bits, codes);
    const std::vector<double> numbers = codeNumbers(codes, bits);
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
      ASSERT_EQ(numbers[i], 128.0);
      ASSERT_EQ(numbers[i + 1], 10.0);
    }
  }
}

}  // namespace
}  // namespace facezip::test
