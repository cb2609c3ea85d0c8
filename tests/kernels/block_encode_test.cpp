// Encoders of blocks: what they say blocks decode to is what a decoder written from the specification makes of them,
// and errors are near the best there is.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <random>

#include "block_picture.hpp"
#include "blocks/bc_encoder.hpp"
#include "facezip/error.hpp"
#include "problems/guarded_buffer.hpp"
#include "reference/block_formats.hpp"
#include "reference/block_search.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::blocks {
namespace {

using device::KernelVariant;
using test::BlockPicture;

struct Coded {
  std::vector<std::byte> blocks;
  std::vector<float> decoded;
};

Coded encode(const EncoderOptions& options, const BlockPicture& picture, std::span<const float> weights = {},
             KernelVariant variant = KernelVariant::kAuto) {
  BcEncoder encoder(test::testDevice(), options, variant);
  Coded coded;
  coded.blocks.resize(blockBytes(options.format, picture.width, picture.rows));
  coded.decoded.resize(picture.texels.size());
  encoder.encode({picture.width, picture.rows, picture.channels, std::span<const float>(picture.texels), weights},
                 coded.blocks, coded.decoded);
  return coded;
}

/// Simulators and llvmpipe take half a minute for every program: few of them there.
EncoderOptions usual(BlockFormat format, int channels) {
  return {format, channels, test::smallSizesOnly() ? Quality::kFast : Quality::kNormal};
}

const std::uint8_t* blockAt(const std::vector<std::byte>& blocks, std::size_t index, std::size_t bytes) {
  return reinterpret_cast<const std::uint8_t*>(blocks.data()) + index * bytes;
}

/// The picture that the reference decodes.
std::vector<double> referenceTexels(BlockFormat format, const BlockPicture& shape,
                                    const std::vector<std::byte>& blocks) {
  std::vector<double> texels(shape.texels.size());
  const int columns = blockCount(shape.width, 4);
  const auto bytes = static_cast<std::size_t>(infoOf(format).block_bytes);
  for (int y = 0; y < shape.rows; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const auto index = static_cast<std::size_t>(y / 4 * columns + x / 4);
      const auto t = static_cast<std::size_t>(y % 4 * 4 + x % 4);
      const std::uint8_t* block = blockAt(blocks, index, bytes);
      for (int c = 0; c < shape.channels; ++c) {
        const auto channel = static_cast<std::size_t>(c);
        double value = 0.0;
        if (format == BlockFormat::kBc1) value = std::floor(reference::decodeBc1(block)[t][channel] + 0.5);
        if (format == BlockFormat::kBc7) value = reference::decodeBc7(block)[t][channel];
        if (format == BlockFormat::kBc4 || format == BlockFormat::kBc5) value = reference::decodeBc4(block + 8 * c)[t];
        texels[shape.at(x, y, c)] = value;
      }
    }
  }
  return texels;
}

double squaredError(const BlockPicture& picture, const std::vector<float>& decoded,
                    std::span<const float> weights = {}) {
  double sum = 0.0;
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    const double rest = static_cast<double>(picture.texels[i]) - static_cast<double>(decoded[i]);
    sum += rest * rest *
           (weights.empty() ? 1.0 : static_cast<double>(weights[i / static_cast<std::size_t>(picture.channels)]));
  }
  return sum;
}

struct Case {
  BlockFormat format;
  int channels;
};
constexpr Case kCases[] = {{BlockFormat::kBc1, 3}, {BlockFormat::kBc1, 1}, {BlockFormat::kBc4, 1},
                           {BlockFormat::kBc5, 2}, {BlockFormat::kBc7, 3}, {BlockFormat::kBc7, 4},
                           {BlockFormat::kBc7, 2}, {BlockFormat::kBc7, 1}};

std::vector<KernelVariant> variants() {
  // GPUs' variant is what llvmpipe gets either way; one is enough for simulators.
  if (test::smallSizesOnly()) return {KernelVariant::kAuto};
  return {KernelVariant::kCpu, KernelVariant::kGpu};
}

std::vector<Quality> qualities() {
  if (test::smallSizesOnly()) return {Quality::kFast};
  return {Quality::kFast, Quality::kNormal, Quality::kBest};
}

TEST(BlockEncode, DecodesToWhatItSays) {
  const std::vector<std::pair<int, int>> sizes =
      test::smallSizesOnly() ? std::vector<std::pair<int, int>>{{7, 5}}
                             : std::vector<std::pair<int, int>>{{1, 1}, {7, 5}, {64, 32}, {93, 41}};
  for (const Case& test_case : kCases) {
    for (const auto& [width, rows] : sizes) {
      const BlockPicture picture = test::blockPicture(width, rows, test_case.channels);
      for (const Quality quality : qualities()) {
        for (const KernelVariant variant : variants()) {
          // Compilers take seconds for each of these.
          if (quality != Quality::kFast && (variant == KernelVariant::kGpu || test_case.channels < 3)) continue;
          if (test::smallSizesOnly() && test_case.channels < infoOf(test_case.format).max_channels - 1) continue;
          const Coded coded = encode({test_case.format, test_case.channels, quality}, picture, {}, variant);
          const std::vector<double> expected = referenceTexels(test_case.format, picture, coded.blocks);
          double largest = 0.0;
          for (std::size_t i = 0; i < expected.size(); ++i) {
            largest = std::max(largest, std::abs(expected[i] - static_cast<double>(coded.decoded[i])));
          }
          const bool whole = test_case.format == BlockFormat::kBc1 || test_case.format == BlockFormat::kBc7;
          EXPECT_LE(largest, whole ? 0.0 : test::kBetweenEnds)
              << infoOf(test_case.format).name << " of " << test_case.channels << ", " << width << " x " << rows
              << ", quality " << static_cast<int>(quality) << ", variant " << static_cast<int>(variant);
        }
      }
    }
  }
}

TEST(BlockEncode, Bc7UsesItsModes) {
  if (test::smallSizesOnly()) GTEST_SKIP() << "needs many blocks";
  std::map<int, int> modes;
  for (const int channels : {3, 4}) {
    const BlockPicture picture = test::blockPicture(256, 256, channels, 3);
    const Coded coded = encode({BlockFormat::kBc7, channels, Quality::kBest}, picture);
    for (std::size_t b = 0; b < coded.blocks.size() / 16; ++b)
      ++modes[reference::bc7Mode(blockAt(coded.blocks, b, 16))];
  }
  for (int mode = 0; mode < 8; ++mode) EXPECT_GT(modes[mode], 0) << "mode " << mode;
  EXPECT_EQ(modes.size(), 8u);
}

TEST(BlockEncode, Bc1IsNeverTransparent) {
  const int side = test::smallSizesOnly() ? 8 : 128;
  const Coded coded = encode(usual(BlockFormat::kBc1, 3), test::blockPicture(side, side, 3, 5));
  int three = 0;
  for (std::size_t b = 0; b < coded.blocks.size() / 8; ++b) {
    const std::uint8_t* block = blockAt(coded.blocks, b, 8);
    if (reference::bc1HasFourColours(block)) continue;
    ++three;
    for (int t = 0; t < 16; ++t) ASSERT_NE(reference::bc1Code(block, t), 3) << "block " << b;
  }
  EXPECT_GE(three, test::smallSizesOnly() ? 0 : 1) << "the other half of this test saw nothing";
}

TEST(BlockEncode, OpaqueWithoutAlpha) {
  const int side = test::smallSizesOnly() ? 8 : 64;
  for (const int channels : {1, 2, 3}) {
    if (test::smallSizesOnly() && channels != 3) continue;
    const Coded coded =
        encode({BlockFormat::kBc7, channels, Quality::kFast}, test::blockPicture(side, side, channels, 7));
    for (std::size_t b = 0; b < coded.blocks.size() / 16; ++b) {
      for (const auto& texel : reference::decodeBc7(blockAt(coded.blocks, b, 16))) ASSERT_GE(texel[3], 254.0);
    }
  }
}

TEST(BlockEncode, Bc4NearTheBestOfAllBlocks) {
  if (test::smallSizesOnly()) GTEST_SKIP() << "tries all blocks";
  BlockPicture picture = test::blockPicture(32, 32, 1, 9);
  // Values that stop at 0, as weights of expressions do.
  for (std::size_t i = 0; i < picture.texels.size() / 4; ++i)
    picture.texels[i] = std::max(0.0f, 2.0f * picture.texels[i] - 300.0f);
  std::vector<float> weights;
  for (std::size_t i = 0; i < picture.texels.size(); ++i)
    weights.push_back(i % 5 == 0 ? 0.0f : 0.5f + static_cast<float>(i % 3));
  std::map<Quality, double> sums;
  double best_sum = 0.0;
  for (const Quality quality : qualities()) {
    const Coded coded = encode({BlockFormat::kBc4, 1, quality}, picture, weights);
    sums[quality] = squaredError(picture, coded.decoded, weights);
  }
  for (int y = 0; y < picture.rows; y += 4) {
    for (int x = 0; x < picture.width; x += 4) {
      std::array<double, 16> texels, texel_weights;
      for (int t = 0; t < 16; ++t) {
        const std::size_t at = picture.at(x + t % 4, y + t / 4, 0);
        texels[static_cast<std::size_t>(t)] = static_cast<double>(picture.texels[at]);
        texel_weights[static_cast<std::size_t>(t)] = static_cast<double>(weights[at]);
      }
      best_sum += reference::bestBc4Error(texels, texel_weights);
    }
  }
  EXPECT_GE(sums[Quality::kBest], best_sum * (1.0 - 1e-6));
  EXPECT_LE(sums[Quality::kBest], best_sum * 1.08);
  EXPECT_LE(sums[Quality::kNormal], best_sum * 1.12);
  EXPECT_LE(sums[Quality::kFast], best_sum * 1.25);
}

TEST(BlockEncode, Bc7NoWorseThanAPlainSearch) {
  const int side = test::smallSizesOnly() ? 8 : 64;
  const BlockPicture picture = test::blockPicture(side, side, 3, 11);
  const Coded coded = encode({BlockFormat::kBc7, 3, Quality::kFast}, picture);
  double plain = 0.0;
  for (int y = 0; y < side; y += 4) {
    for (int x = 0; x < side; x += 4) {
      std::array<std::array<double, 3>, 16> texels;
      for (int t = 0; t < 16; ++t) {
        for (int c = 0; c < 3; ++c) {
          texels[static_cast<std::size_t>(t)][static_cast<std::size_t>(c)] =
              static_cast<double>(picture.texels[picture.at(x + t % 4, y + t / 4, c)]);
        }
      }
      plain += reference::plainMode6Error(texels);
    }
  }
  EXPECT_LE(squaredError(picture, coded.decoded), plain);
}

TEST(BlockEncode, EffortPays) {
  if (test::smallSizesOnly()) GTEST_SKIP() << "compiles every effort";
  for (const Case& test_case : kCases) {
    if (test_case.format == BlockFormat::kBc7 && test_case.channels < 3) continue;
    const BlockPicture picture = test::blockPicture(128, 128, test_case.channels, 13);
    std::vector<double> errors;
    for (const Quality quality : qualities()) {
      errors.push_back(squaredError(picture, encode({test_case.format, test_case.channels, quality}, picture).decoded));
    }
    EXPECT_LE(errors[1], errors[0]) << infoOf(test_case.format).name << " of " << test_case.channels;
    EXPECT_LE(errors[2], errors[1]) << infoOf(test_case.format).name << " of " << test_case.channels;
  }
}

TEST(BlockEncode, TexelsWithoutWeightAreFree) {
  const int side = test::smallSizesOnly() ? 16 : 64;
  for (const Case& test_case : kCases) {
    if (test_case.channels < infoOf(test_case.format).max_channels) continue;
    if (test::smallSizesOnly() && test_case.format != BlockFormat::kBc7) continue;
    BlockPicture picture = test::blockPicture(side, side, test_case.channels, 15);
    std::vector<float> weights;
    std::mt19937 random(2);
    for (int i = 0; i < side * side; ++i) weights.push_back(random() % 3 == 0 ? 0.0f : 1.0f);
    const double plain =
        squaredError(picture, encode(usual(test_case.format, test_case.channels), picture).decoded, weights);
    const Coded coded = encode(usual(test_case.format, test_case.channels), picture, weights);
    EXPECT_LT(squaredError(picture, coded.decoded, weights), 0.97 * plain) << infoOf(test_case.format).name;
    // What they are makes no difference.
    for (std::size_t p = 0; p < weights.size(); ++p) {
      for (int c = 0; c < test_case.channels; ++c) {
        if (weights[p] == 0.0f)
          picture.texels[p * static_cast<std::size_t>(test_case.channels) + static_cast<std::size_t>(c)] = 3.0f;
      }
    }
    const Coded other = encode(usual(test_case.format, test_case.channels), picture, weights);
    EXPECT_NEAR(squaredError(picture, other.decoded, weights), squaredError(picture, coded.decoded, weights),
                0.01 * squaredError(picture, coded.decoded, weights));
  }
}

TEST(BlockEncode, BlocksWithoutWeightsAreCodedAllTheSame) {
  if (test::smallSizesOnly()) GTEST_SKIP() << "compiles more programs";
  const BlockPicture picture = test::blockPicture(8, 8, 3, 17);
  const std::vector<float> none(64, 0.0f);
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc7}) {
    EXPECT_EQ(encode(usual(format, 3), picture, none).blocks, encode(usual(format, 3), picture).blocks);
  }
}

TEST(BlockEncode, ChannelsCountByTheirWeights) {
  const int side = test::smallSizesOnly() ? 8 : 64;
  const BlockPicture picture = test::blockPicture(side, side, 3, 19);
  const auto channelError = [&](const Coded& coded, std::size_t c) {
    double sum = 0.0;
    for (std::size_t i = c; i < coded.decoded.size(); i += 3)
      sum += std::pow(static_cast<double>(picture.texels[i] - coded.decoded[i]), 2.0);
    return sum;
  };
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc7}) {
    const auto weighted = [&](const std::array<float, 4>& weights) {
      EncoderOptions options = usual(format, 3);
      options.channel_weights = weights;
      return options;
    };
    const Coded even = encode(usual(format, 3), picture);
    const Coded uneven = encode(weighted({16.0f, 1.0f, 1.0f, 1.0f}), picture);
    EXPECT_LT(channelError(uneven, 0), 0.8 * channelError(even, 0)) << infoOf(format).name;
    // A common factor changes nothing.
    const Coded scaled = encode(weighted({0.25f, 0.25f, 0.25f, 0.25f}), picture);
    EXPECT_NEAR(squaredError(picture, scaled.decoded), squaredError(picture, even.decoded),
                0.01 * squaredError(picture, even.decoded));
  }
}

TEST(BlockEncode, FractionsOfCodesAreKept) {
  // Between two codes, the mean of a block tells which way to round more often.
  BlockPicture picture{4, 4, 1, std::vector<float>(16, 100.0f)};
  for (std::size_t t = 0; t < 16; ++t) picture.texels[t] = 100.0f + static_cast<float>(t) / 16.0f;
  const Coded coded = encode(usual(BlockFormat::kBc4, 1), picture);
  EXPECT_LT(squaredError(picture, coded.decoded), 16.0 * 0.004);  // whole codes would leave 1/12 a texel
}

TEST(BlockEncode, BytesAreFloats) {
  if (test::smallSizesOnly()) GTEST_SKIP() << "compiles more programs";
  BlockPicture picture = test::blockPicture(12, 8, 3, 21);
  std::vector<std::uint8_t> bytes;
  for (float& texel : picture.texels) {
    texel = std::floor(std::clamp(texel, 0.0f, 255.0f));
    bytes.push_back(static_cast<std::uint8_t>(texel));
  }
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc7}) {
    BcEncoder encoder(test::testDevice(), usual(format, 3));
    std::vector<std::byte> blocks(blockBytes(format, 12, 8));
    encoder.encode({12, 8, 3, std::span<const std::uint8_t>(bytes), {}}, blocks, {});
    EXPECT_EQ(blocks, encode(usual(format, 3), picture).blocks);
  }
}

TEST(BlockEncode, TilesGiveTheSameBlocks) {
  const int width = 37, rows = 21, channels = 3, textures = 2;
  device::DeviceContext& context = test::testDevice();
  const BlockPicture picture = test::blockPicture(width, rows, channels, 23);
  // Tiles of the picture in some order, the middle one of the upper row left out.
  const std::vector<cl_int2> positions = {{{2, 1}}, {{0, 0}}, {{0, 1}}, {{1, 1}}, {{2, 0}}};
  std::vector<float> samples(positions.size() * textures * channels * kTileTexels, -1e6f);
  std::vector<float> weights(positions.size() * kTileTexels, 0.0f);
  std::vector<float> picture_weights(static_cast<std::size_t>(width * rows), 1.0f);
  for (std::size_t i = 0; i < picture_weights.size(); ++i) picture_weights[i] = i % 7 == 0 ? 0.25f : 1.0f;
  const auto sampleAt = [&](std::size_t tile, int c, int t) {
    return ((tile * textures + 1) * channels + static_cast<std::size_t>(c)) * kTileTexels + static_cast<std::size_t>(t);
  };
  for (std::size_t tile = 0; tile < positions.size(); ++tile) {
    for (int t = 0; t < kTileTexels; ++t) {
      const int x = positions[tile].s[0] * kTileSide + t % kTileSide;
      const int y = positions[tile].s[1] * kTileSide + t / kTileSide;
      if (x >= width || y >= rows) continue;
      for (int c = 0; c < channels; ++c) samples[sampleAt(tile, c, t)] = picture.texels[picture.at(x, y, c)];
      weights[tile * kTileTexels + static_cast<std::size_t>(t)] =
          picture_weights[static_cast<std::size_t>(y * width + x)];
    }
  }
  const cl::Buffer tiles = context.upload(positions, "tiles");
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc7}) {
    if (test::smallSizesOnly() && format == BlockFormat::kBc7) continue;
    BcEncoder encoder(context, usual(format, channels));
    DeviceTexels texels;
    texels.layout = TexelLayout::inTiles(width, rows, channels, tiles, positions.size(), textures, 1);
    texels.samples = context.upload(samples, "samples");
    texels.weights = context.upload(weights, "weights");
    test::GuardedBuffer blocks(context, blockBytes(format, width, rows));
    test::GuardedBuffer decoded(context, samples.size() * sizeof(float));
    encoder.fill(blocks.buffer(), width, rows, std::vector<float>{10.0f, 20.0f, 30.0f});
    encoder.encodeOnDevice(texels, blocks.buffer(), decoded.buffer());
    const std::vector<std::byte> got = blocks.read<std::byte>();
    const std::vector<float> got_decoded = decoded.read<float>();
    const Coded expected = encode(usual(format, channels), picture, picture_weights);
    BlockPicture flat{4, 4, channels, {}};
    for (int t = 0; t < 16; ++t) flat.texels.insert(flat.texels.end(), {10.0f, 20.0f, 30.0f});
    const std::vector<std::byte> constant = encode(usual(format, channels), flat).blocks;
    const auto bytes = static_cast<std::size_t>(infoOf(format).block_bytes);
    for (int y = 0; y < blockCount(rows, 4); ++y) {
      for (int x = 0; x < blockCount(width, 4); ++x) {
        const std::size_t at = static_cast<std::size_t>(y * blockCount(width, 4) + x) * bytes;
        const bool listed = x / 4 != 1 || y / 4 != 0;
        const std::byte* wanted = listed ? &expected.blocks[at] : constant.data();
        ASSERT_EQ(std::memcmp(&got[at], wanted, bytes), 0) << infoOf(format).name << " block " << x << ", " << y;
      }
    }
    for (std::size_t tile = 0; tile < positions.size(); ++tile) {
      for (int t = 0; t < kTileTexels; ++t) {
        const int x = positions[tile].s[0] * kTileSide + t % kTileSide;
        const int y = positions[tile].s[1] * kTileSide + t / kTileSide;
        if (x >= width || y >= rows) continue;
        for (int c = 0; c < channels; ++c) {
          ASSERT_EQ(got_decoded[sampleAt(tile, c, t)], expected.decoded[picture.at(x, y, c)]);
        }
      }
    }
  }
}

TEST(BlockEncode, PlanesGiveTheSameBlocks) {
  device::DeviceContext& context = test::testDevice();
  const BlockPicture picture = test::blockPicture(21, 10, 3, 25);
  std::vector<float> planes;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = c; i < picture.texels.size(); i += 3) planes.push_back(picture.texels[i]);
  }
  DeviceTexels texels;
  texels.layout = TexelLayout::planar(21, 10);
  texels.samples = context.upload(planes, "samples");
  BcEncoder encoder(context, usual(BlockFormat::kBc7, 3));
  test::GuardedBuffer blocks(context, blockBytes(BlockFormat::kBc7, 21, 10));
  test::GuardedBuffer decoded(context, planes.size() * sizeof(float));
  encoder.encodeOnDevice(texels, blocks.buffer(), decoded.buffer());
  decoded.read<float>();
  EXPECT_EQ(blocks.read<std::byte>(), encode(usual(BlockFormat::kBc7, 3), picture).blocks);
}

TEST(BlockEncode, SameBytesEveryTime) {
  const int side = test::smallSizesOnly() ? 8 : 64;
  for (const Case& test_case : kCases) {
    if (test::smallSizesOnly() && test_case.channels != 3) continue;
    const BlockPicture picture = test::blockPicture(side, side, test_case.channels, 27);
    const Coded first = encode(usual(test_case.format, test_case.channels), picture);
    const Coded second = encode(usual(test_case.format, test_case.channels), picture);
    EXPECT_EQ(first.blocks, second.blocks);
    // A band codes to what the whole does.
    BlockPicture band = picture;
    band.rows = 4;
    band.texels.resize(band.texels.size() / static_cast<std::size_t>(side) * 4);
    const Coded part = encode(usual(test_case.format, test_case.channels), band);
    EXPECT_EQ(std::memcmp(part.blocks.data(), first.blocks.data(), part.blocks.size()), 0);
  }
}

TEST(BlockEncode, RefusesWhatItCannotHold) {
  device::DeviceContext& context = test::testDevice();
  EXPECT_THROW(BcEncoder(context, {BlockFormat::kBc4, 2}), InputError);
  EXPECT_THROW(BcEncoder(context, {BlockFormat::kBc5, 3}), InputError);
  EXPECT_THROW(BcEncoder(context, {BlockFormat::kBc1, 4}), InputError);
  EXPECT_THROW(BcEncoder(context, {BlockFormat::kBc7, 0}), InputError);
  BcEncoder encoder(context, {BlockFormat::kBc7, 3});
  DeviceTexels texels;
  texels.layout = TexelLayout::interleaved(8, 8, 3);
  texels.samples = context.allocate(8 * 8 * 3 * sizeof(float) - 1, CL_MEM_READ_ONLY, "samples");
  const cl::Buffer blocks = context.allocate(64, CL_MEM_READ_WRITE, "blocks");
  EXPECT_THROW(encoder.encodeOnDevice(texels, blocks, {}), DeviceError);
  texels.samples = context.allocate(8 * 8 * 3 * sizeof(float), CL_MEM_READ_ONLY, "samples");
  const cl::Buffer few = context.allocate(63, CL_MEM_READ_WRITE, "blocks");
  EXPECT_THROW(encoder.encodeOnDevice(texels, few, {}), DeviceError);
}

}  // namespace
}  // namespace facezip::blocks
