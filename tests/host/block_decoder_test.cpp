#include "blocks/block_decoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "blocks/bc_decoder.hpp"
#include "facezip/error.hpp"
#include "reference/block_formats.hpp"

namespace facezip::blocks {
namespace {

std::vector<std::byte> anyBytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::byte> bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

const std::uint8_t* raw(const std::vector<std::byte>& bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

TEST(BlockDecoder, Bc7BlocksOfEveryMode) {
  for (unsigned mode = 0; mode <= 8; ++mode) {
    for (unsigned seed = 0; seed < 2000; ++seed) {
      std::vector<std::byte> block = anyBytes(16, seed);
      block[0] = mode == 8 ? std::byte{0} : (block[0] << (mode + 1)) | (std::byte{1} << mode);
      const reference::BlockTexels expected = reference::decodeBc7(raw(block));
      const BlockColours got = decodeBc7(std::span<const std::byte, 16>(block));
      for (std::size_t t = 0; t < 16; ++t) {
        for (std::size_t c = 0; c < 4; ++c) {
          ASSERT_EQ(got[t][c], expected[t][c]) << "mode " << mode << " seed " << seed << " texel " << t;
        }
      }
    }
  }
}

TEST(BlockDecoder, EveryPartition) {
  // Modes with partitions, every one of them: bits from the mode on.
  for (const unsigned mode : {0u, 1u, 2u, 3u, 7u}) {
    for (unsigned partition = 0; partition < (mode == 0 ? 16u : 64u); ++partition) {
      std::vector<std::byte> block = anyBytes(16, partition);
      const unsigned field_bits = mode + 1 + (mode == 0 ? 4 : 6);
      unsigned low = std::to_integer<unsigned>(block[0]) | std::to_integer<unsigned>(block[1]) << 8;
      low = (low & ~((1u << field_bits) - 1)) | 1u << mode | partition << (mode + 1);
      block[0] = static_cast<std::byte>(low);
      block[1] = static_cast<std::byte>(low >> 8);
      const reference::BlockTexels expected = reference::decodeBc7(raw(block));
      const BlockColours got = decodeBc7(std::span<const std::byte, 16>(block));
      for (std::size_t t = 0; t < 16; ++t) {
        for (std::size_t c = 0; c < 4; ++c)
          ASSERT_EQ(got[t][c], expected[t][c]) << "mode " << mode << " partition " << partition;
      }
    }
  }
}

TEST(BlockDecoder, Bc1AndBc4Blocks) {
  int three_colours = 0;
  int six_steps = 0;
  for (unsigned seed = 0; seed < 5000; ++seed) {
    const std::vector<std::byte> block = anyBytes(8, seed);
    const std::span<const std::byte, 8> fixed(block);
    three_colours += reference::bc1HasFourColours(raw(block)) ? 0 : 1;
    six_steps += block[0] <= block[1] ? 1 : 0;
    const reference::BlockTexels colours = reference::decodeBc1(raw(block));
    const std::array<double, 16> values = reference::decodeBc4(raw(block));
    for (std::size_t t = 0; t < 16; ++t) {
      for (std::size_t c = 0; c < 4; ++c) ASSERT_EQ(decodeBc1(fixed)[t][c], std::floor(colours[t][c] + 0.5)) << seed;
      ASSERT_NEAR(static_cast<double>(decodeBc4(fixed)[t]), values[t], 5e-5) << seed;
    }
  }
  EXPECT_GT(three_colours, 1000);
  EXPECT_GT(six_steps, 1000);
}

TEST(BlockDecoder, PicturesThatBlocksHangOver) {
  for (const auto& [width, rows] : {std::pair{1, 1}, {5, 3}, {16, 4}, {33, 18}}) {
    for (const auto& [format, channels] : {std::pair{BlockFormat::kBc1, 3},
                                           {BlockFormat::kBc4, 1},
                                           {BlockFormat::kBc5, 2},
                                           {BlockFormat::kBc7, 4},
                                           {BlockFormat::kBc7, 2}}) {
      const std::vector<std::byte> blocks = anyBytes(blockBytes(format, width, rows), 7);
      const std::size_t samples = static_cast<std::size_t>(width * rows * channels);
      std::vector<float> floats(samples, -1.0f);
      std::vector<std::uint8_t> bytes(samples);
      const auto decoder = makeBlockDecoder(format, channels);
      decoder->decode(width, rows, blocks, std::span(floats));
      decoder->decode(width, rows, blocks, std::span(bytes));
      for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < width; ++x) {
          const std::size_t index = static_cast<std::size_t>(y / 4 * blockCount(width, 4) + x / 4);
          const std::uint8_t* block = raw(blocks) + index * static_cast<std::size_t>(infoOf(format).block_bytes);
          const auto t = static_cast<std::size_t>(y % 4 * 4 + x % 4);
          for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
            const double expected = format == BlockFormat::kBc7   ? reference::decodeBc7(block)[t][c]
                                    : format == BlockFormat::kBc1 ? std::floor(reference::decodeBc1(block)[t][c] + 0.5)
                                                                  : reference::decodeBc4(block + 8 * c)[t];
            const std::size_t at = static_cast<std::size_t>(y * width + x) * static_cast<std::size_t>(channels) + c;
            ASSERT_NEAR(static_cast<double>(floats[at]), expected, 5e-5);
            ASSERT_EQ(bytes[at], static_cast<std::uint8_t>(floats[at] + 0.5f));
          }
        }
      }
    }
  }
}

TEST(BlockDecoder, AnyBytesAreAstcBlocks) {
  for (const BlockFormatInfo& info : blockFormats()) {
    if (!isAstc(info.format)) continue;
    const int width = 3 * info.block_width - 1;
    const int rows = 2 * info.block_height + 1;
    const std::vector<std::byte> blocks = anyBytes(blockBytes(info.format, width, rows), 3);
    const std::size_t samples = static_cast<std::size_t>(width * rows) * 3;
    std::vector<float> floats(samples, -1.0f);
    std::vector<std::uint8_t> bytes(samples);
    const auto decoder = makeBlockDecoder(info.format, 3);
    decoder->decode(width, rows, blocks, std::span(floats));
    decoder->decode(width, rows, blocks, std::span(bytes));
    for (std::size_t i = 0; i < samples; ++i) {
      ASSERT_GE(floats[i], 0.0f) << info.name;
      ASSERT_LE(floats[i], 255.0f) << info.name;
      ASSERT_NEAR(floats[i], static_cast<float>(bytes[i]), 0.51f) << info.name;
    }
  }
}

TEST(BlockDecoder, RefusesChannelsThatAreNotThere) {
  EXPECT_THROW(makeBlockDecoder(BlockFormat::kBc4, 2), InputError);
  EXPECT_THROW(makeBlockDecoder(BlockFormat::kAstc6x6, 5), InputError);
}

}  // namespace
}  // namespace facezip::blocks
