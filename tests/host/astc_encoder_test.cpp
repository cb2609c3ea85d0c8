#include "blocks/astc_encoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "blocks/block_decoder.hpp"
#include "facezip/error.hpp"
#include "test_device.hpp"

namespace facezip::blocks {
namespace {

struct Picture {
  int width, rows, channels;
  std::vector<float> texels;
};

Picture picture(int width, int rows, int channels) {
  std::mt19937 random(5);
  std::normal_distribution<float> grain(0.0f, 2.0f);
  Picture result{width, rows, channels, {}};
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const float wave = std::sin(0.15f * static_cast<float>(x + 2 * c)) *
                           std::cos(0.11f * static_cast<float>(y) + static_cast<float>(c));
        result.texels.push_back(128.0f + 60.0f * wave + grain(random));
      }
    }
  }
  return result;
}

struct Coded {
  std::vector<std::byte> blocks;
  std::vector<float> decoded;
};

Coded encode(const EncoderOptions& options, const Picture& of, std::span<const float> weights = {}) {
  const auto encoder = makeBlockEncoder(test::testDevice().context(), options);
  Coded coded{std::vector<std::byte>(blockBytes(options.format, of.width, of.rows)),
              std::vector<float>(of.texels.size())};
  encoder->encode({of.width, of.rows, of.channels, std::span<const float>(of.texels), weights}, coded.blocks,
                  coded.decoded);
  return coded;
}

double rmse(const Picture& of, const Coded& coded, int channel = -1, std::span<const float> weights = {}) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < of.texels.size(); ++i) {
    const auto channels = static_cast<std::size_t>(of.channels);
    if (channel >= 0 && i % channels != static_cast<std::size_t>(channel)) continue;
    const double weight = weights.empty() ? 1.0 : static_cast<double>(weights[i / channels]);
    sum += weight * std::pow(static_cast<double>(of.texels[i] - coded.decoded[i]), 2.0);
    count += weight;
  }
  return std::sqrt(sum / count);
}

TEST(AstcEncoder, DecodesToWhatItSays) {
  for (const BlockFormatInfo& info : blockFormats()) {
    if (!isAstc(info.format)) continue;
    for (int channels = 1; channels <= 4; ++channels) {
      const Picture of = picture(61, 35, channels);
      const Coded coded = encode({info.format, channels, Quality::kFast}, of);
      std::vector<float> decoded(of.texels.size());
      makeBlockDecoder(info.format, channels)->decode(of.width, of.rows, coded.blocks, std::span(decoded));
      EXPECT_EQ(decoded, coded.decoded) << info.name << " of " << channels;
      const double texels_of_block = info.block_width * info.block_height;
      EXPECT_LT(rmse(of, coded), 1.8 + 0.12 * texels_of_block) << info.name << " of " << channels;
    }
  }
}

TEST(AstcEncoder, BetterWithEffortAndFewerChannels) {
  const Picture of = picture(96, 96, 3);
  const double fast = rmse(of, encode({BlockFormat::kAstc6x6, 3, Quality::kFast}, of));
  const double normal = rmse(of, encode({BlockFormat::kAstc6x6, 3, Quality::kNormal}, of));
  const double best = rmse(of, encode({BlockFormat::kAstc6x6, 3, Quality::kBest}, of));
  EXPECT_LE(normal, fast * 1.001);
  EXPECT_LE(best, normal * 1.001);
  // Two channels as luminance and alpha; as red and green of three they would err by more.
  Picture two = picture(96, 96, 2);
  Picture padded{96, 96, 3, {}};
  for (std::size_t p = 0; p < two.texels.size() / 2; ++p)
    padded.texels.insert(padded.texels.end(), {two.texels[2 * p], two.texels[2 * p + 1], 0.0f});
  const Coded as_three = encode({BlockFormat::kAstc6x6, 3}, padded);
  const double of_three = std::hypot(rmse(padded, as_three, 0), rmse(padded, as_three, 1)) / std::sqrt(2.0);
  EXPECT_LT(rmse(two, encode({BlockFormat::kAstc6x6, 2}, two)), of_three);
}

TEST(AstcEncoder, FractionsOfCodesAreKept) {
  Picture of{48, 48, 3, {}};
  for (int p = 0; p < 48 * 48; ++p) {
    for (int c = 0; c < 3; ++c)
      of.texels.push_back(100.0f + 4.0f * std::sin(0.2f * static_cast<float>(p % 48 + p / 48)));
  }
  Picture rounded = of;
  for (float& texel : rounded.texels) texel = std::round(texel);
  EncoderOptions options{BlockFormat::kAstc4x4, 3};
  options.astc_effort = {60.0f, 0.05f};
  EXPECT_LT(rmse(of, encode(options, of)), 0.8 * rmse(of, encode(options, rounded)));
}

TEST(AstcEncoder, ChannelsCountByTheirWeights) {
  const Picture of = picture(96, 96, 3);
  const Coded even = encode({BlockFormat::kAstc8x8, 3}, of);
  const Coded uneven = encode({BlockFormat::kAstc8x8, 3, Quality::kNormal, {9.0f, 1.0f, 1.0f, 1.0f}}, of);
  EXPECT_LT(rmse(of, uneven, 0), 0.9 * rmse(of, even, 0));
}

TEST(AstcEncoder, TexelsWithoutWeightAreFree) {
  Picture of = picture(96, 60, 3);
  std::vector<float> weights;
  for (int y = 0; y < of.rows; ++y) {
    for (int x = 0; x < of.width; ++x) weights.push_back((x / 3 + y / 5) % 3 == 0 ? 0.0f : 1.0f);
  }
  // Another colour altogether beyond the border.
  for (std::size_t i = 0; i < of.texels.size(); ++i) {
    if (weights[i / 3] == 0.0f) of.texels[i] = i % 3 == 0 ? 250.0f : 5.0f;
  }
  double before = rmse(of, encode({BlockFormat::kAstc6x6, 3, Quality::kFast}, of), -1, weights);
  for (const Quality quality : {Quality::kFast, Quality::kNormal, Quality::kBest}) {
    const Coded coded = encode({BlockFormat::kAstc6x6, 3, quality}, of, weights);
    const double error = rmse(of, coded, -1, weights);
    EXPECT_LT(error, quality == Quality::kFast ? 0.75 * before : before) << static_cast<int>(quality);
    before = error;
  }
}

TEST(AstcEncoder, WeightsInBetween) {
  const Picture of = picture(60, 60, 3);
  std::vector<float> weights;
  for (std::size_t i = 0; i < of.texels.size() / 3; ++i) weights.push_back(i % 4 == 0 ? 4.0f : 0.2f);
  const double plain = rmse(of, encode({BlockFormat::kAstc8x8, 3, Quality::kBest}, of), -1, weights);
  EXPECT_LT(rmse(of, encode({BlockFormat::kAstc8x8, 3, Quality::kBest}, of, weights), -1, weights), plain);
  // Equal ones are none.
  const std::vector<float> equal(weights.size(), 0.3f);
  EXPECT_EQ(encode({BlockFormat::kAstc8x8, 3}, of, equal).blocks, encode({BlockFormat::kAstc8x8, 3}, of).blocks);
}

TEST(AstcEncoder, SameBytesEveryTime) {
  const Picture of = picture(122, 61, 3);
  EXPECT_EQ(encode({BlockFormat::kAstc5x5, 3}, of).blocks, encode({BlockFormat::kAstc5x5, 3}, of).blocks);
}

TEST(AstcEncoder, BytesAreNearlyFloats) {
  Picture of = picture(60, 60, 3);
  std::vector<std::uint8_t> bytes;
  for (float& texel : of.texels) {
    texel = std::round(texel);
    bytes.push_back(static_cast<std::uint8_t>(texel));
  }
  AstcEncoder encoder({BlockFormat::kAstc5x5, 3});
  Coded coded{std::vector<std::byte>(blockBytes(BlockFormat::kAstc5x5, 60, 60)), std::vector<float>(of.texels.size())};
  encoder.encode({60, 60, 3, std::span<const std::uint8_t>(bytes), {}}, coded.blocks, coded.decoded);
  const double as_floats = rmse(of, encode({BlockFormat::kAstc5x5, 3}, of));
  EXPECT_NEAR(rmse(of, coded), as_floats, 0.01 * as_floats);
}

TEST(AstcEncoder, RefusesFiveChannels) { EXPECT_THROW(AstcEncoder({BlockFormat::kAstc4x4, 5}), InputError); }

}  // namespace
}  // namespace facezip::blocks
