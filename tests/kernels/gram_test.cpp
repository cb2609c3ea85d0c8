#include "compress/search/gram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>
#include <vector>

#include "canary_buffer.hpp"
#include "compress/bands/difference.hpp"
#include "reference/difference.hpp"
#include "reference/gram.hpp"
#include "synthetic_band.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

using device::KernelVariant;
using image::SampleType;

/// With --small: a simulator takes seconds for a single tile.
bool isTooLarge(const BandShape& shape) { return test::smallSizesOnly() && shape.width * shape.rows >= 640; }

/// Every mask and every pair that shares a tile.
GramSlots slotsOf(const std::vector<TileMasks>& bands, int mask_count) {
  std::set<std::pair<int, int>> pairs;
  for (const TileMasks& masks : bands) {
    for (std::size_t t = 0; t < masks.tiles.size(); ++t) {
      for (int a = masks.mask_begin[t]; a < masks.mask_begin[t + 1]; ++a) {
        for (int b = a + 1; b < masks.mask_begin[t + 1]; ++b) {
          pairs.insert({masks.mask_index[static_cast<std::size_t>(a)], masks.mask_index[static_cast<std::size_t>(b)]});
        }
      }
    }
  }
  GramSlots slots{mask_count, {}};
  for (const auto& [k, l] : pairs) slots.pairs.push_back({k, l});
  return slots;
}

void addBand(GramAccumulator& gram, const test::SyntheticBand& band, const TileMasks& masks, double metric_weight) {
  device::DeviceContext& context = test::testDevice();
  DeviceTiles tiles(context);
  tiles.upload(masks);
  const cl::Buffer samples = context.upload(band.samples, "samples");
  const cl::Buffer differences =
      context.allocate(differenceBufferBytes(band.shape, masks.tiles.size()), CL_MEM_READ_WRITE, "differences");
  computeDifferences(context, tiles, band.shape, samples, differences);
  gram.add(tiles, differences, band.shape, metric_weight);
}

/// The tiles of a band for the reference.
std::vector<reference::GramTile> referenceTiles(const test::SyntheticBand& band, const TileMasks& masks) {
  const BandShape& shape = band.shape;
  const std::vector<double> differences =
      reference::differences(band.values, test::tilePositions(masks), shape.width, shape.rows, shape.channels,
                             shape.expressions, static_cast<double>(image::unit255(shape.sample_type)));
  const std::size_t per_tile = differences.size() / masks.tiles.size();
  std::vector<reference::GramTile> tiles(masks.tiles.size());
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const auto first = differences.begin() + static_cast<std::ptrdiff_t>(t * per_tile);
    tiles[t].differences.assign(first, first + static_cast<std::ptrdiff_t>(per_tile));
    const auto texels = masks.texel_weights.begin() + static_cast<std::ptrdiff_t>(t * kTileTexels);
    tiles[t].texel_weights.assign(texels, texels + kTileTexels);
    for (int e = masks.mask_begin[t]; e < masks.mask_begin[t + 1]; ++e) {
      const auto weights = masks.mask_weights.begin() + static_cast<std::ptrdiff_t>(e) * kTileTexels;
      tiles[t].masks.push_back({masks.mask_index[static_cast<std::size_t>(e)], {weights, weights + kTileTexels}});
    }
  }
  return tiles;
}

/// Compares one slot; `expected` is what the bands add up to.
void expectSlot(const GramMatrices& actual, int slot, const std::vector<double>& expected) {
  const auto matrix = actual.slot(slot);
  const auto n_count = static_cast<std::size_t>(actual.expressions);
  for (std::size_t n = 0; n < n_count; ++n) {
    for (std::size_t m = 0; m < n_count; ++m) {
      const double scale = std::sqrt(expected[n * n_count + n] * expected[m * n_count + m]);
      const double value = matrix(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(m));
      ASSERT_NEAR(value, expected[n * n_count + m], test::kGramRelative * scale)
          << "slot " << slot << ", expressions " << n << " and " << m;
      ASSERT_EQ(value, matrix(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(n))) << "not symmetric";
    }
  }
}

struct Case {
  BandShape shape;
  int masks;
  int most_masks;
};

/// llvmpipe has no kCpu variant; running kGpu twice would only look like a test of it.
void skipIfNotOnThisDevice(KernelVariant variant) {
  if (test::testDevice().resolve(variant) != variant) GTEST_SKIP() << "the device has one variant only";
}

class Gram : public testing::TestWithParam<std::tuple<Case, KernelVariant>> {
 protected:
  void SetUp() override { skipIfNotOnThisDevice(std::get<1>(GetParam())); }
};

TEST_P(Gram, EqualsReference) {
  const auto& [which, variant] = GetParam();
  const BandShape& shape = which.shape;
  if (isTooLarge(shape)) GTEST_SKIP() << "small sizes only";
  const test::SyntheticBand band = test::makeBand(shape, 3);
  const TileMasks masks = test::makeTileMasks(shape, which.masks, which.most_masks, 4);
  const GramSlots slots = slotsOf({masks}, which.masks);
  GramAccumulator accumulator(test::testDevice(), slots, shape.expressions, variant);
  addBand(accumulator, band, masks, 0.75);
  const GramMatrices actual = accumulator.finish();

  const std::vector<reference::GramTile> tiles = referenceTiles(band, masks);
  const auto check = [&](int slot, int k, int l) {
    std::vector<double> expected = reference::gram(tiles, shape.expressions, shape.channels, k, l);
    for (double& value : expected) value *= 0.75;
    expectSlot(actual, slot, expected);
  };
  check(slots.whole(), -1, -1);
  for (int k = 0; k < slots.masks; ++k) check(slots.mask(k), k, -1);
  for (std::size_t j = 0; j < slots.pairs.size(); ++j) {
    check(slots.pair(static_cast<int>(j)), slots.pairs[j].k, slots.pairs[j].l);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Gram,
                         testing::Combine(testing::Values(Case{{20, 16, 3, 3, SampleType::kUint8}, 3, 2},
                                                          Case{{93, 16, 3, 3, SampleType::kUint8}, 5, 3},
                                                          Case{{93, 10, 1, 1, SampleType::kUint8}, 4, 4},
                                                          Case{{40, 16, 4, 5, SampleType::kUint16}, 3, 2},
                                                          Case{{93, 32, 3, 20, SampleType::kUint8}, 14, 12},
                                                          Case{{93, 32, 4, 37, SampleType::kFloat32}, 13, 12},
                                                          Case{{93, 10, 3, 20, SampleType::kUint16}, 9, 8},
                                                          Case{{1024, 80, 1, 3, SampleType::kUint8}, 20, 4},
                                                          Case{{1040, 16, 1, 2, SampleType::kUint8}, 40, 16}),
                                          testing::Values(KernelVariant::kCpu, KernelVariant::kGpu)));

class GramVariant : public testing::TestWithParam<KernelVariant> {
 protected:
  void SetUp() override { skipIfNotOnThisDevice(GetParam()); }
};

TEST_P(GramVariant, BandsAndMapsAddUp) {
  if (test::smallSizesOnly()) GTEST_SKIP() << "small sizes only";
  const int mask_count = 4;
  const BandShape colours{93, 16, 3, 3, SampleType::kUint8};
  const BandShape heights{93, 10, 1, 3, SampleType::kFloat32};
  const TileMasks first = test::makeTileMasks(colours, mask_count, 3, 5);
  const TileMasks second = test::makeTileMasks(heights, mask_count, 3, 6);
  const test::SyntheticBand colour_band = test::makeBand(colours, 7);
  const test::SyntheticBand height_band = test::makeBand(heights, 8);
  const GramSlots slots = slotsOf({first, second}, mask_count);
  GramAccumulator accumulator(test::testDevice(), slots, 3, GetParam());
  addBand(accumulator, colour_band, first, 1.0);
  addBand(accumulator, height_band, second, 0.125);
  const GramMatrices actual = accumulator.finish();
  std::vector<double> expected = reference::gram(referenceTiles(colour_band, first), 3, 3, 2, -1);
  const std::vector<double> more = reference::gram(referenceTiles(height_band, second), 3, 1, 2, -1);
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += 0.125 * more[i];
  expectSlot(actual, slots.mask(2), expected);

  // finish() starts again from zero.
  addBand(accumulator, colour_band, first, 1.0);
  expectSlot(accumulator.finish(), slots.whole(), reference::gram(referenceTiles(colour_band, first), 3, 3, -1, -1));
}

TEST_P(GramVariant, EqualExpressionsHaveEqualRowsAndTheSameBitsEveryTime) {
  const BandShape shape{93, 16, 3, 6, SampleType::kUint8};
  if (isTooLarge(shape)) GTEST_SKIP() << "small sizes only";
  test::SyntheticBand band = test::makeBand(shape, 9);
  // Expression 4 (another block than 1) becomes expression 1.
  const std::size_t image = band.samples.size() / 7;
  std::copy_n(band.samples.begin() + static_cast<std::ptrdiff_t>(2 * image), image,
              band.samples.begin() + static_cast<std::ptrdiff_t>(5 * image));
  const TileMasks masks = test::makeTileMasks(shape, 5, 4, 10);
  GramAccumulator accumulator(test::testDevice(), slotsOf({masks}, 5), 6, GetParam());
  addBand(accumulator, band, masks, 1.0);
  const GramMatrices once = accumulator.finish();
  for (int slot = 0; slot < once.slots.count(); ++slot) {
    const auto matrix = once.slot(slot);
    EXPECT_EQ(matrix(1, 1) + matrix(4, 4) - 2.0 * matrix(1, 4), 0.0) << "slot " << slot;
    for (int m = 0; m < 6; ++m) EXPECT_EQ(matrix(1, m), matrix(4, m)) << "slot " << slot << ", expression " << m;
  }
  addBand(accumulator, band, masks, 1.0);
  EXPECT_EQ(accumulator.finish().values, once.values);
}

TEST_P(GramVariant, PairsThatAreNotListedAreLeftOut) {
  const BandShape shape{40, 16, 1, 2, SampleType::kUint8};
  const test::SyntheticBand band = test::makeBand(shape, 11);
  const TileMasks masks = test::makeTileMasks(shape, 3, 3, 12);
  GramAccumulator accumulator(test::testDevice(), GramSlots{3, {{0, 2}}}, 2, GetParam());
  addBand(accumulator, band, masks, 1.0);
  const GramMatrices actual = accumulator.finish();
  const std::vector<reference::GramTile> tiles = referenceTiles(band, masks);
  expectSlot(actual, actual.slots.mask(1), reference::gram(tiles, 2, 1, 1, -1));
  expectSlot(actual, actual.slots.pair(0), reference::gram(tiles, 2, 1, 0, 2));
}

/// With little room for partial sums a band takes several launches, over tiles and over blocks; the sums may not
/// change.
TEST_P(GramVariant, LaunchesAddUp) {
  const BandShape shape{1400, 16, 1, 13, SampleType::kUint8};  // 88 places for tiles, 10 blocks
  if (isTooLarge(shape)) GTEST_SKIP() << "small sizes only";
  const TileMasks masks = test::makeTileMasks(shape, 9, 4, 13);
  const GramSlots slots = slotsOf({masks}, 9);
  const test::SyntheticBand band = test::makeBand(shape, 14);
  GramAccumulator accumulator(test::testDevice(), slots, shape.expressions, GetParam());
  addBand(accumulator, band, masks, 1.0);
  const GramMatrices expected = accumulator.finish();
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{30000}}) {
    GramAccumulator limited(test::testDevice(), slots, shape.expressions, GetParam(), bytes);
    addBand(limited, band, masks, 1.0);
    const GramMatrices actual = limited.finish();
    for (int slot = 0; slot < slots.count(); ++slot) {
      // Two plans are added in double, one by compensated sums on the device: equal but for the last bits of float32.
      ASSERT_TRUE(actual.slot(slot).isApprox(expected.slot(slot), 1e-12)) << bytes << " bytes, slot " << slot;
    }
  }
}

TEST_P(GramVariant, RefusesABufferThatIsTooSmall) {
  device::DeviceContext& context = test::testDevice();
  const BandShape shape{93, 16, 3, 2, SampleType::kUint8};
  const TileMasks masks = test::makeTileMasks(shape, 3, 1, 2);
  DeviceTiles tiles(context);
  tiles.upload(masks);
  const cl::Buffer small =
      context.allocate(differenceBufferBytes(shape, masks.tiles.size()) - 1, CL_MEM_READ_WRITE, "differences");
  GramAccumulator accumulator(context, slotsOf({masks}, 3), 2, GetParam());
  EXPECT_THROW(accumulator.add(tiles, small, shape, 1.0), DeviceError);
}

/// A plain float32 sum of these drops every summand but the first.
TEST(GramReduce, CompensatesWhatRoundingDrops) {
  device::DeviceContext& context = test::testDevice();
  constexpr std::size_t kLanes = 16;
  constexpr int kRows = 1000;
  std::vector<float> partial(kRows * kLanes, 0.03125f);
  std::fill_n(partial.begin(), kLanes, 1e6f);  // half a unit in its last place is 0.03125
  std::vector<cl_int> rows(kRows);
  std::iota(rows.begin(), rows.end(), 0);
  const test::CanaryBuffer sums(context, kLanes * sizeof(cl_float2));
  context.launch(context.kernel("gram_reduce.cl", "gram_reduce"), device::WorkItems(kLanes, 1).inGroupsOf(kLanes, 1),
                 context.upload(partial, "partial sums"),
                 context.upload(std::vector<cl_int>{0, kRows}, "rows of the slots"), context.upload(rows, "rows"),
                 sums);
  context.finish();
  for (const cl_float2 sum : sums.read<cl_float2>()) {
    EXPECT_EQ(static_cast<double>(sum.s[0]) + static_cast<double>(sum.s[1]), 1e6 + 999 * 0.03125);
  }
}

/// What does not fit into a launch goes into the next: every tile is in one plan, whole runs at a time.
TEST(GramPlan, SplitsAtTheLimitOfRows) {
  const BandShape shape{1024, 64, 1, 2, SampleType::kUint8};
  const TileMasks masks = test::makeTileMasks(shape, 10, 4, 17);
  const GramSlots slots = slotsOf({masks}, 10);
  DeviceTiles tiles(test::testDevice());
  tiles.upload(masks);
  const std::size_t all = planGram(tiles, slots, PairSlots(slots), 0, std::numeric_limits<std::size_t>::max()).rows();
  std::size_t rows = 0;
  int plans = 0;
  for (std::size_t tile = 0; tile < tiles.tileCount(); ++plans) {
    const GramPlan plan = planGram(tiles, slots, PairSlots(slots), tile, all / 2);
    ASSERT_EQ(plan.first_tile, tile);
    ASSERT_GT(plan.tile_count, 0u);
    EXPECT_TRUE(plan.rows() <= all / 2 || plan.runs() == 1);
    EXPECT_EQ(plan.touched_rows.size(), plan.rows());
    EXPECT_EQ(plan.run_begin.back(), static_cast<int>(tile + plan.tile_count));
    rows += plan.rows();
    tile += plan.tile_count;
  }
  EXPECT_GT(plans, 1);
  EXPECT_EQ(rows, all);
}

INSTANTIATE_TEST_SUITE_P(Variants, GramVariant, testing::Values(KernelVariant::kCpu, KernelVariant::kGpu));

}  // namespace
}  // namespace facezip::compress
