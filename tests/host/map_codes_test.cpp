#include "codes/map_codes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "blocks/block_decoder.hpp"
#include "blocks/block_encoder.hpp"
#include "test_device.hpp"

namespace facezip::compress {
namespace {

float zeroCode(const TextureEncoding& e) { return std::round(-e.offset / e.scale); }

TEST(CodesOfBlocks, HoldTheRangeAndZero) {
  const std::vector<TextureRange> ranges = {{-31.7f, 90.1f}, {-80.0f, 2.0f},  {-1.0f, 1.0f},
                                            {0.0f, 40.0f},   {-40.0f, -5.0f}, {-0.1f, 200.0f}};
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc7, BlockFormat::kAstc6x6}) {
    const MapCodes codes = codesOfBlocks(ranges, format, 2);
    EXPECT_EQ(codes.formats, std::vector<BlockFormat>(2, format));
    for (std::size_t plane = 0; plane < ranges.size(); ++plane) {
      const TextureEncoding& e = codes.encoding[plane];
      const float zero = zeroCode(e);
      EXPECT_EQ(e.scale * zero + e.offset, 0.0f);
      // Where zero is an end, the other side is clamped: less than a step of BC1's ends of 5 bits.
      const float missed = format == BlockFormat::kBc1 ? 8.0f * e.scale : 0.51f * e.scale;
      EXPECT_LE(e.offset, ranges[plane].min + missed) << blockFormatName(format) << " " << plane;
      EXPECT_GE(e.offset + 255.0f * e.scale, ranges[plane].max - missed) << blockFormatName(format) << " " << plane;
    }
  }
}

TEST(CodesOfBlocks, GiveZeroACodeThatBlocksOfOneColourHave) {
  const std::vector<TextureRange> ranges = {{-31.7f, 90.1f}, {-83.0f, 21.0f}, {-11.0f, 14.0f}};
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc7, BlockFormat::kAstc6x6}) {
    const MapCodes codes = codesOfBlocks(ranges, format, 1);
    std::vector<float> texels;
    for (int t = 0; t < 36; ++t) {
      for (const TextureEncoding& e : codes.encoding) texels.push_back(zeroCode(e));
    }
    blocks::EncoderOptions options;
    options.format = format;
    std::vector<std::byte> bytes(blocks::blockBytes(format, 6, 6));
    std::vector<float> decoded(texels.size());
    blocks::makeBlockEncoder(test::testDevice().context(), options)
        ->encode({6, 6, 3, std::span<const float>(texels), {}}, bytes, decoded);
    // ASTC's are exact to the halves that GPUs decode to.
    const float most = format == BlockFormat::kAstc6x6 ? 0.07f : 0.0f;
    for (std::size_t s = 0; s < texels.size(); ++s) EXPECT_NEAR(decoded[s], texels[s], most) << blockFormatName(format);
  }
}

}  // namespace
}  // namespace facezip::compress
