// Difference textures in blocks, one after the other: what the blocks hold, what is left, and that each mends what
// those before it got wrong.
#include "codes/coded_textures.hpp"

#include <gtest/gtest.h>

#include "blocks/block_decoder.hpp"
#include "codes/block_weights.hpp"
#include "codes/tile_rows.hpp"
#include "device/strided_copy.hpp"
#include "problems/difference_fit.hpp"
#include "test_device.hpp"

namespace facezip::test {
namespace {
using compress::CodedTextures;
using compress::TextureCoding;
using compress::TextureEncoding;

/// Tiles that blocks do not divide, with texels in the gutter and texels of no face.
constexpr GridSizes kSizes{{83, 37, 3, 9, image::SampleType::kUint8}, 8, 4, 0, 0};
constexpr float kScale = 2.0f;
constexpr float kZero = 132.0f;  // blocks of one colour have it exactly in every format but BC1

struct CodedProblem : DifferenceFitProblem {
  CodedProblem() : DifferenceFitProblem(testDevice(), kSizes, scatteredTexels(kSizes.shape, 5), Free::kAllRows) {}

  TextureCoding coding(BlockFormat format) const {
    return {std::vector<BlockFormat>(toSize(space.textures), format),
            std::vector<TextureEncoding>(toSize(planes()), {kScale, -kScale * kZero}), shape.channels};
  }
  std::size_t channelFloats() const { return toSize(shape.channels, kTileTexels); }

  /// Squared error that textures leave, texel weights in it.
  double errorOf(const std::vector<float>& textures) const {
    double error = 0.0;
    for (std::size_t tile = 0; tile < tileCount(); ++tile) {
      for (int t = 0; t < kTileTexels; ++t) {
        if (texelWeight(tile, t) == 0.0) continue;
        const Eigen::MatrixXd left = deltaOf(tile, t) - weightsOf(tile, t).transpose() * textureOf(textures, tile, t);
        error += texelWeight(tile, t) * left.squaredNorm();
      }
    }
    return error;
  }
};

class CodedTexturesTest : public testing::TestWithParam<BlockFormat> {
 protected:
  void SetUp() override {
    if (smallSizesOnly()) GTEST_SKIP() << "large for a simulator";
  }
};

TEST_P(CodedTexturesTest, AreWhatTheirBlocksDecodeTo) {
  CodedProblem problem;
  CodedTextures coded(testDevice(), problem.space, problem.coding(GetParam()), blocks::Quality::kFast, true);
  coded.setTiles(problem.masks);
  const cl::Buffer& buffer = coded.compute(problem.band(), problem.window, problem.ridge);
  const auto textures = testDevice().download<float>(buffer, problem.textureLayout().size(), "textures");
  const auto decoder = blocks::makeBlockDecoder(GetParam(), problem.shape.channels);
  std::vector<float> rows(toSize(problem.shape.rows, problem.shape.width, problem.shape.channels));
  for (int i = 0; i < problem.space.textures; ++i) {
    decoder->decode(problem.shape.width, problem.shape.rows, coded.blocks(i), std::span(rows));
    std::vector<float> tiles(problem.tileCount() * problem.channelFloats(), kZero);
    compress::rowsToTiles(problem.masks.tiles, problem.shape, rows, tiles);
    for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
      for (int t = 0; t < kTileTexels; ++t) {
        if (problem.x(tile, t) >= problem.shape.width || problem.y(tile, t) >= problem.shape.rows) continue;
        for (int c = 0; c < problem.shape.channels; ++c) {
          const float code = tiles[tile * problem.channelFloats() + toSize(c * kTileTexels + t)];
          const float d = textures[problem.textureLayout()(tile, i * problem.shape.channels + c, t)];
          ASSERT_NEAR(d, kScale * (code - kZero), 1e-3f) << "texture " << i;
        }
      }
    }
  }
}

TEST_P(CodedTexturesTest, SayWhatTheyLeave) {
  CodedProblem problem;
  CodedTextures coded(testDevice(), problem.space, problem.coding(GetParam()), blocks::Quality::kFast, false);
  coded.setTiles(problem.masks);
  const cl::Buffer& buffer = coded.compute(problem.band(), problem.window, problem.ridge);
  const double expected =
      problem.errorOf(testDevice().download<float>(buffer, problem.textureLayout().size(), "textures"));
  double error = 0.0;
  for (const compress::FitError& of_tile : coded.errors()) error += of_tile.weighted;
  EXPECT_NEAR(error, expected, 1e-4 * expected);
}

TEST_P(CodedTexturesTest, MendWhatThoseBeforeGotWrong) {
  CodedProblem problem;
  CodedTextures coded(testDevice(), problem.space, problem.coding(GetParam()), blocks::Quality::kFast, false);
  coded.setTiles(problem.masks);
  const cl::Buffer& buffer = coded.compute(problem.band(), problem.window, problem.ridge);
  const double in_turn =
      problem.errorOf(testDevice().download<float>(buffer, problem.textureLayout().size(), "textures"));

  // The textures that suit the weights best, each coded for itself.
  problem.run();
  std::vector<float> codes = problem.result();
  for (float& code : codes) code = code / kScale + kZero;
  const cl::Buffer apart = testDevice().upload(codes, "codes");
  const std::vector<float> weights = compress::blockWeights(problem.masks);
  const cl::Buffer weights_buffer = testDevice().upload(weights, "weights");
  blocks::EncoderOptions options;
  options.format = GetParam();
  options.quality = blocks::Quality::kFast;
  const auto coder = compress::makeTextureCoder(testDevice(), options);
  const std::vector<float> zero(toSize(problem.shape.channels), kZero);
  for (int i = 0; i < problem.space.textures; ++i) {
    coder->code({problem.tiles, problem.shape, problem.masks.tiles, weights, weights_buffer},
                {apart, problem.space.textures, i}, zero, {});
  }
  testDevice().read(apart, codes, "codes");
  for (float& code : codes) code = kScale * (code - kZero);
  EXPECT_LT(in_turn, 0.9 * problem.errorOf(codes));
}

INSTANTIATE_TEST_SUITE_P(Formats, CodedTexturesTest,
                         testing::Values(BlockFormat::kBc1, BlockFormat::kBc7, BlockFormat::kAstc4x4,
                                         BlockFormat::kAstc8x5),
                         [](const auto& format) {
                           std::string name(blockFormatName(format.param));
                           std::erase(name, '-');
                           return name;
                         });

TEST(TileRows, GoForthAndBack) {
  const BandShape shape{35, 18, 2, 1, image::SampleType::kUint8};
  const std::vector<raster::TilePosition> tiles = {{1, 0}, {2, 0}, {0, 1}};
  std::vector<float> rows(toSize(shape.rows, shape.width, shape.channels));
  for (std::size_t s = 0; s < rows.size(); ++s) rows[s] = static_cast<float>(s);
  std::vector<float> values(tiles.size() * toSize(shape.channels, kTileTexels), -1.0f);
  compress::rowsToTiles(tiles, shape, rows, values);
  EXPECT_EQ(values[kTileTexels + 17], rows[2 * (1 * 35 + 17) + 1]);  // row 1, column 16 + 1, channel 1
  EXPECT_EQ(values[2 * kTileTexels + 3], -1.0f);                     // column 35 hangs over
  std::vector<float> back(rows.size(), -1.0f);
  compress::tilesToRows(tiles, shape, values, back);
  for (int y = 0; y < shape.rows; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const bool in_tile = (y < 16) == (x >= 16);
      const std::size_t place = 2 * toSize(y * shape.width + x);
      EXPECT_EQ(back[place], in_tile && !(y >= 16 && x >= 16) ? rows[place] : -1.0f) << x << " " << y;
    }
  }
}

TEST(StridedCopy, TakesPiecesAndPutsThemBack) {
  std::vector<float> values(40);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  const cl::Buffer buffer = testDevice().upload(values, "values");
  const device::Strided pieces{6, 3, 10, 4};
  std::vector<float> taken(12);
  device::readStrided(testDevice(), buffer, pieces, taken);
  EXPECT_EQ(taken, (std::vector<float>{6, 7, 8, 16, 17, 18, 26, 27, 28, 36, 37, 38}));
  for (float& value : taken) value = -value;
  device::writeStrided(testDevice(), buffer, pieces, taken);
  testDevice().read(buffer, values, "values");
  EXPECT_EQ(values[16], -16.0f);
  EXPECT_EQ(values[19], 19.0f);
}

}  // namespace
}  // namespace facezip::test
