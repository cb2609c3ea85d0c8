#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "blocks/device_block_decoder.hpp"
#include "problems/guarded_buffer.hpp"
#include "reference/block_formats.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::blocks {
namespace {

/// Any bits at all; of BC7 as many blocks of every mode, and some of none.
std::vector<std::uint8_t> anyBlocks(BlockFormat format, std::size_t count) {
  std::mt19937 random(4);
  const auto bytes = static_cast<std::size_t>(infoOf(format).block_bytes);
  std::vector<std::uint8_t> blocks(count * bytes);
  for (std::uint8_t& byte : blocks) byte = static_cast<std::uint8_t>(random());
  for (std::size_t b = 0; format == BlockFormat::kBc7 && b < count; ++b) {
    std::uint8_t& first = blocks[b * bytes];
    const unsigned mode = b % 9;
    first = mode == 8 ? std::uint8_t{0} : static_cast<std::uint8_t>((first << (mode + 1) | 1u << mode) & 255u);
  }
  return blocks;
}

double referenceTexel(BlockFormat format, const std::uint8_t* block, std::size_t t, std::size_t c) {
  if (format == BlockFormat::kBc7) return reference::decodeBc7(block)[t][c];
  // A transparent texel has no other colour than black.
  if (format == BlockFormat::kBc1) return std::floor(reference::decodeBc1(block)[t][c] + 0.5);
  return reference::decodeBc4(block + 8 * c)[t];
}

TEST(BlockDecode, IsTheReference) {
  device::DeviceContext& context = test::testDevice();
  const int width = test::smallSizesOnly() ? 18 : 401;
  const int rows = test::smallSizesOnly() ? 9 : 93;
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc4, BlockFormat::kBc5, BlockFormat::kBc7}) {
    const int channels = infoOf(format).max_channels;
    const auto bytes = static_cast<std::size_t>(infoOf(format).block_bytes);
    const std::vector<std::uint8_t> blocks = anyBlocks(format, blockBytes(format, width, rows) / bytes);
    const cl::Buffer on_device = context.upload(blocks, "blocks");
    const auto samples = static_cast<std::size_t>(width * rows * channels);
    test::GuardedBuffer floats(context, samples * sizeof(float));
    test::GuardedBuffer whole(context, samples);
    const TexelLayout layout = TexelLayout::interleaved(width, rows, channels);
    decodeOnDevice(context, format, channels, on_device, layout, DecodedType::kFloat, floats.buffer());
    decodeOnDevice(context, format, channels, on_device, layout, DecodedType::kUint8, whole.buffer());
    const std::vector<float> got = floats.read<float>();
    const std::vector<std::uint8_t> got_whole = whole.read<std::uint8_t>();
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::uint8_t* block = &blocks[static_cast<std::size_t>(y / 4 * blockCount(width, 4) + x / 4) * bytes];
        for (int c = 0; c < channels; ++c) {
          const double expected =
              referenceTexel(format, block, static_cast<std::size_t>(y % 4 * 4 + x % 4), static_cast<std::size_t>(c));
          const auto at = static_cast<std::size_t>((y * width + x) * channels + c);
          ASSERT_NEAR(static_cast<double>(got[at]), expected, test::kBetweenEnds)
              << infoOf(format).name << " " << x << ", " << y;
          ASSERT_NEAR(static_cast<double>(got_whole[at]), expected, 0.5 + test::kBetweenEnds) << infoOf(format).name;
        }
      }
    }
  }
}

TEST(BlockDecode, FewerChannelsAndTiles) {
  device::DeviceContext& context = test::testDevice();
  const int width = 20, rows = 18;
  const std::vector<std::uint8_t> blocks =
      anyBlocks(BlockFormat::kBc7, blockBytes(BlockFormat::kBc7, width, rows) / 16);
  const cl::Buffer on_device = context.upload(blocks, "blocks");
  const std::vector<cl_int2> positions = {{{1, 0}}, {{0, 1}}, {{0, 0}}};
  const cl::Buffer tiles = context.upload(positions, "tiles");
  test::GuardedBuffer texels(context, positions.size() * 2 * kTileTexels * sizeof(float));
  decodeOnDevice(context, BlockFormat::kBc7, 2, on_device,
                 TexelLayout::inTiles(width, rows, 2, tiles, positions.size(), 1, 0), DecodedType::kFloat,
                 texels.buffer());
  const std::vector<float> got = texels.read<float>();
  for (std::size_t tile = 0; tile < positions.size(); ++tile) {
    for (int t = 0; t < kTileTexels; ++t) {
      const int x = positions[tile].s[0] * kTileSide + t % kTileSide;
      const int y = positions[tile].s[1] * kTileSide + t / kTileSide;
      if (x >= width || y >= rows) continue;
      const std::uint8_t* block = &blocks[static_cast<std::size_t>(y / 4 * blockCount(width, 4) + x / 4) * 16];
      for (std::size_t c = 0; c < 2; ++c) {
        const std::size_t at = (tile * 2 + c) * kTileTexels + static_cast<std::size_t>(t);
        ASSERT_EQ(static_cast<double>(got[at]),
                  reference::decodeBc7(block)[static_cast<std::size_t>(y % 4 * 4 + x % 4)][c]);
      }
    }
  }
}

}  // namespace
}  // namespace facezip::blocks
