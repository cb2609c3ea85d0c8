#include "compress/search/difference_texture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "canary_buffer.hpp"
#include "compress/bands/difference.hpp"
#include "compress/codes/texture_encoder.hpp"
#include "compress/codes/texture_range.hpp"
#include "reference/difference.hpp"
#include "reference/difference_texture.hpp"
#include "synthetic_band.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

using image::SampleType;

struct Case {
  BandShape shape;
  int masks;
  int most_masks;
  int textures;
};

std::vector<TextureRange> rangesOf(const DifferenceTextures& textures, int count, const DeviceTiles& tiles,
                                   const BandShape& shape) {
  return TextureRangeFinder(test::testDevice(), count).find(tiles, shape, textures.textures(), 0, tiles.tileCount());
}

/// Every expression in one texture of each mask, with 1 / (size of the cluster).
TextureCoefficients makeCoefficients(int masks, int textures, int expressions) {
  std::mt19937_64 random(21);
  TextureCoefficients table{masks, textures, expressions, {}};
  table.values.assign(static_cast<std::size_t>(masks * textures * expressions), 0.0f);
  for (int k = 0; k < masks; ++k) {
    std::vector<int> texture_of(static_cast<std::size_t>(expressions));
    std::vector<int> size(static_cast<std::size_t>(textures));
    for (int& texture : texture_of) {
      texture = test::intRandom(random, textures);
      ++size[static_cast<std::size_t>(texture)];
    }
    for (int n = 0; n < expressions; ++n) {
      const int i = texture_of[static_cast<std::size_t>(n)];
      table.values[static_cast<std::size_t>((k * textures + i) * expressions + n)] =
          1.0f / static_cast<float>(size[static_cast<std::size_t>(i)]);
    }
  }
  return table;
}

/// A band on the device with its difference textures, and the same from the reference.
struct Computed {
  explicit Computed(const Case& which, device::KernelVariant variant = device::KernelVariant::kAuto)
      : shape(which.shape),
        band(test::makeBand(shape, 15)),
        masks(test::makeTileMasks(shape, which.masks, which.most_masks, 16)),
        table(makeCoefficients(which.masks, which.textures, shape.expressions)),
        tiles(test::testDevice()),
        textures(test::testDevice(), table, variant) {
    device::DeviceContext& context = test::testDevice();
    tiles.upload(masks);
    const cl::Buffer samples = context.upload(band.samples, "samples");
    const cl::Buffer differences =
        context.allocate(differenceBufferBytes(shape, masks.tiles.size()), CL_MEM_READ_WRITE, "differences");
    computeDifferences(context, tiles, shape, samples, differences);
    const cl::Buffer& buffer = textures.compute(tiles, differences, shape);
    actual.resize(masks.tiles.size() * planes() * kTileTexels);
    context.read(buffer, actual, "textures");
    computeReference();
  }

  std::size_t planes() const { return static_cast<std::size_t>(table.textures * shape.channels); }

  void computeReference() {
    const std::vector<double> differences =
        reference::differences(band.values, test::tilePositions(masks), shape.width, shape.rows, shape.channels,
                               shape.expressions, static_cast<double>(image::unit255(shape.sample_type)));
    const auto per_tile = static_cast<std::ptrdiff_t>(shape.expressions * shape.channels * kTileTexels);
    for (std::size_t t = 0; t < masks.tiles.size(); ++t) {
      const auto first = differences.begin() + static_cast<std::ptrdiff_t>(t) * per_tile;
      std::vector<std::pair<int, std::vector<double>>> active;
      for (int e = masks.mask_begin[t]; e < masks.mask_begin[t + 1]; ++e) {
        const auto weights = masks.mask_weights.begin() + static_cast<std::ptrdiff_t>(e) * kTileTexels;
        active.push_back({masks.mask_index[static_cast<std::size_t>(e)], {weights, weights + kTileTexels}});
      }
      const std::vector<double> tile = reference::differenceTexture(
          active, table.values, table.textures, shape.expressions, shape.channels, {first, first + per_tile});
      expected.insert(expected.end(), tile.begin(), tile.end());
    }
  }

  /// True if a mask of tile `t` is above zero at texel `p`.
  bool covered(std::size_t t, std::size_t p) const {
    for (int e = masks.mask_begin[t]; e < masks.mask_begin[t + 1]; ++e) {
      if (masks.mask_weights[static_cast<std::size_t>(e) * kTileTexels + p] > 0.0f) return true;
    }
    return false;
  }

  BandShape shape;
  test::SyntheticBand band;
  TileMasks masks;
  TextureCoefficients table;
  DeviceTiles tiles;
  DifferenceTextures textures;
  std::vector<float> actual;     ///< [tile][plane][256]
  std::vector<double> expected;  ///< the same
};

void skipLargeSizes(const Case& which) {
  const BandShape& shape = which.shape;
  if (test::smallSizesOnly() && (shape.expressions > 3 || shape.width * shape.rows > 930))
    GTEST_SKIP() << "small sizes only";
}

class DifferenceTexture : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override { skipLargeSizes(GetParam()); }
};

TEST_P(DifferenceTexture, EqualsReference) {
  const Computed computed(GetParam());
  ASSERT_EQ(computed.actual.size(), computed.expected.size());
  const double full_scale = computed.shape.sample_type == SampleType::kFloat32 ? 2.0 * 255.0 : 255.0;
  for (std::size_t i = 0; i < computed.actual.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(computed.actual[i]), computed.expected[i],
                test::kDifferenceTextureRelative * full_scale)
        << "at " << i;
  }
}

TEST_P(DifferenceTexture, VariantsHaveTheSameBits) {
  const Computed wide(GetParam(), device::KernelVariant::kCpu);
  const Computed narrow(GetParam(), device::KernelVariant::kGpu);
  EXPECT_EQ(wide.actual, narrow.actual);
}

TEST_P(DifferenceTexture, RangeCoversTheTexelsUnderAMask) {
  Computed computed(GetParam());
  const std::vector<TextureRange> ranges =
      rangesOf(computed.textures, computed.table.textures, computed.tiles, computed.shape);
  ASSERT_EQ(ranges.size(), computed.planes());
  for (std::size_t plane = 0; plane < ranges.size(); ++plane) {
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (std::size_t t = 0; t < computed.masks.tiles.size(); ++t) {
      for (std::size_t p = 0; p < kTileTexels; ++p) {
        if (!computed.covered(t, p)) continue;
        const float value = computed.actual[(t * computed.planes() + plane) * kTileTexels + p];
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
    EXPECT_EQ(ranges[plane].min, low) << "plane " << plane;
    EXPECT_EQ(ranges[plane].max, high) << "plane " << plane;
  }
}

std::vector<double> toNumbers(std::span<const std::byte> codes, int bits) {
  std::vector<double> numbers(codes.size() / static_cast<std::size_t>(bits / 8));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::uint16_t wide = static_cast<std::uint16_t>(codes[i]);
    if (bits == 16) std::memcpy(&wide, codes.data() + 2 * i, 2);
    numbers[i] = wide;
  }
  return numbers;
}

class DifferenceTextureCodes : public testing::TestWithParam<std::tuple<Case, int>> {
 protected:
  void SetUp() override { skipLargeSizes(std::get<0>(GetParam())); }
};

TEST_P(DifferenceTextureCodes, AreThoseOfEveryTexelOfTheBand) {
  const auto& [which, bits] = GetParam();
  Computed computed(which);
  const BandShape& shape = computed.shape;
  const double largest = bits == 16 ? 65535.0 : 255.0;
  std::vector<TextureEncoding> encoding;
  for (std::size_t plane = 0; plane < computed.planes(); ++plane) {
    // Narrower than the values, so that some are clamped; the last plane is a constant.
    const float scale = (0.25f + 0.125f * static_cast<float>(plane)) * 255.0f / static_cast<float>(largest);
    encoding.push_back({plane + 1 == computed.planes() ? 0.0f : scale, -20.5f});
  }
  const auto texels = static_cast<std::size_t>(shape.rows) * static_cast<std::size_t>(shape.width);
  const std::size_t bytes = texels * computed.planes() * static_cast<std::size_t>(bits / 8);
  std::vector<std::byte> guarded(bytes + 64, std::byte{0xA5});
  TextureEncoder(test::testDevice(), computed.table.textures)
      .encode(computed.tiles, shape, computed.textures.textures(), encoding, bits, std::span(guarded).first(bytes));
  for (std::size_t i = bytes; i < guarded.size(); ++i) ASSERT_EQ(guarded[i], std::byte{0xA5});
  const std::vector<double> codes = toNumbers(std::span(guarded).first(bytes), bits);

  // Values of the band in rows; 0 where there is no tile.
  std::vector<double> values(texels * computed.planes(), 0.0);
  const auto channels = static_cast<std::size_t>(shape.channels);
  for (std::size_t t = 0; t < computed.masks.tiles.size(); ++t) {
    for (std::size_t plane = 0; plane < computed.planes(); ++plane) {
      for (std::size_t p = 0; p < kTileTexels; ++p) {
        const auto x = static_cast<std::size_t>(computed.masks.tiles[t].x) * kTileSide + p % kTileSide;
        const auto y = static_cast<std::size_t>(computed.masks.tiles[t].y) * kTileSide + p / kTileSide;
        if (x >= static_cast<std::size_t>(shape.width) || y >= static_cast<std::size_t>(shape.rows)) continue;
        const std::size_t texel = plane / channels * texels + y * static_cast<std::size_t>(shape.width) + x;
        values[texel * channels + plane % channels] =
            static_cast<double>(computed.actual[(t * computed.planes() + plane) * kTileTexels + p]);
      }
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t plane = i / (texels * channels) * channels + i % channels;
    const double position = reference::codePosition(values[i], static_cast<double>(encoding[plane].scale),
                                                    static_cast<double>(encoding[plane].offset), largest);
    // Half upwards, with room for the last bits of float32 at the half itself.
    ASSERT_GE(codes[i], position - 0.5 - test::kEncodeTie * largest) << "at " << i;
    ASSERT_LE(codes[i], position + 0.5 + test::kEncodeTie * largest) << "at " << i;
  }
}

const auto kCases = testing::Values(
    Case{{37, 16, 3, 3, SampleType::kUint8}, 3, 2, 4}, Case{{93, 16, 3, 3, SampleType::kUint8}, 5, 4, 4},
    Case{{93, 10, 1, 1, SampleType::kUint8}, 3, 2, 1}, Case{{40, 16, 4, 3, SampleType::kUint16}, 3, 3, 2},
    Case{{93, 32, 3, 20, SampleType::kUint8}, 14, 12, 4}, Case{{93, 32, 4, 37, SampleType::kFloat32}, 13, 12, 8},
    Case{{93, 10, 1, 6, SampleType::kFloat32}, 9, 8, 3});
INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceTexture, kCases);
INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceTextureCodes, testing::Combine(kCases, testing::Values(8, 16)));

/// One expression that differs by 1 everywhere, under one mask that is 1 in the upper half of a tile and 0 below.
struct HalfTile {
  HalfTile() : tiles(test::testDevice()), textures(test::testDevice(), {1, 1, 1, {1.0f}}) {
    TileMasks masks;
    masks.tiles = {{0, 0}};
    masks.mask_begin = {0, 1};
    masks.mask_index = {0};
    masks.mask_weights.assign(kTileTexels, 0.0f);
    std::fill_n(masks.mask_weights.begin(), kTileTexels / 2, 1.0f);
    masks.texel_weights.assign(kTileTexels, 1.0f);
    tiles.upload(masks);
    textures.compute(tiles, test::testDevice().upload(std::vector<cl_short>(kTileTexels, 1), "differences"), shape);
  }

  BandShape shape{16, 16, 1, 1, SampleType::kUint8};
  DeviceTiles tiles;
  DifferenceTextures textures;
};

TEST(DifferenceTexture, RangeLeavesOutTexelsWithoutAMask) {
  HalfTile tile;
  const std::vector<TextureRange> ranges = rangesOf(tile.textures, 1, tile.tiles, tile.shape);
  ASSERT_EQ(ranges.size(), 1u);
  EXPECT_EQ(ranges[0].min, 1.0f);
  EXPECT_EQ(ranges[0].max, 1.0f);
}

TEST(DifferenceTexture, HalvesRoundUpwards) {
  HalfTile tile;  // scale 2 makes 0.5 of 1
  std::vector<double> expected(kTileTexels, 0.0);
  std::fill_n(expected.begin(), kTileTexels / 2, 1.0);
  for (const int bits : {8, 16}) {
    std::vector<std::byte> codes(static_cast<std::size_t>(kTileTexels * bits / 8));
    TextureEncoder(test::testDevice(), 1)
        .encode(tile.tiles, tile.shape, tile.textures.textures(), std::vector<TextureEncoding>{{2.0f, 0.0f}}, bits,
                codes);
    EXPECT_EQ(toNumbers(codes, bits), expected) << bits;
  }
}

/// Texels outside the masks must decode to 0, not nearly: with the encodings that compress chooses, at their largest
/// codes.
TEST(DifferenceTexture, ZeroHasItsCodeInEveryEncoding) {
  HalfTile tile;  // below its middle there is no mask
  std::mt19937 random(3);
  std::uniform_real_distribution<float> end(0.01f, 200.0f);
  for (int round = 0; round < 100; ++round) {
    const float low = -end(random), high = round % 2 == 0 ? 0.0f : end(random);
    for (const int bits : {8, 16}) {
      const TextureEncoding encoding = encodingFor({low, high}, bits);
      std::vector<std::byte> codes(static_cast<std::size_t>(kTileTexels * bits / 8));
      TextureEncoder(test::testDevice(), 1)
          .encode(tile.tiles, tile.shape, tile.textures.textures(), std::vector<TextureEncoding>{encoding}, bits,
                  codes);
      const double zero = static_cast<double>(-encoding.offset / encoding.scale);
      ASSERT_EQ(toNumbers(codes, bits).back(), zero) << low << " " << high << " " << bits;
    }
  }
}

TEST(DifferenceTexture, BandWithoutTilesIsTheCodeOfZero) {
  const BandShape shape{33, 5, 2, 2, SampleType::kUint8};
  device::DeviceContext& context = test::testDevice();
  TileMasks none;
  none.mask_begin = {0};
  DeviceTiles tiles(context);
  tiles.upload(none);
  DifferenceTextures textures(context, {1, 1, 2, {0.5f, 0.5f}});
  textures.compute(tiles, context.allocate(1, CL_MEM_READ_WRITE, "none"), shape);
  for (const TextureRange& range : rangesOf(textures, 1, tiles, shape)) EXPECT_GT(range.min, range.max);
  for (const int bits : {8, 16}) {
    std::vector<std::byte> codes(static_cast<std::size_t>(33 * 5 * 2 * bits / 8));
    TextureEncoder(test::testDevice(), 1)
        .encode(tiles, shape, textures.textures(), std::vector<TextureEncoding>{{1.0f, -128.0f}, {2.0f, -20.0f}}, bits,
                codes);
    const std::vector<double> numbers = toNumbers(codes, bits);
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
      ASSERT_EQ(numbers[i], 128.0);
      ASSERT_EQ(numbers[i + 1], 10.0);
    }
  }
}

TEST(DifferenceTexture, RefusesABufferThatIsTooSmall) {
  device::DeviceContext& context = test::testDevice();
  const BandShape shape{93, 16, 3, 2, SampleType::kUint8};
  const TileMasks masks = test::makeTileMasks(shape, 3, 1, 2);
  DeviceTiles tiles(context);
  tiles.upload(masks);
  const cl::Buffer small =
      context.allocate(differenceBufferBytes(shape, masks.tiles.size()) - 1, CL_MEM_READ_WRITE, "differences");
  DifferenceTextures textures(context, makeCoefficients(3, 4, 2));
  EXPECT_THROW(textures.compute(tiles, small, shape), DeviceError);
}

}  // namespace
}  // namespace facezip::compress
