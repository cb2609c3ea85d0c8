#include "problems/gram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using compress::GramAccumulator;
using compress::GramMatrices;
using compress::GramSlots;
using device::KernelVariant;
using image::SampleType;

/// With --small: a simulator takes seconds for a single tile.
bool isTooLarge(const BandShape& shape) { return smallSizesOnly() && shape.width * shape.rows >= 640; }

/// Compares one slot.
void expectSlot(const GramMatrices& actual, int slot, const std::vector<double>& expected) {
  const auto matrix = actual.slot(slot);
  const Layout places(actual.expressions, actual.expressions);
  for (int n = 0; n < actual.expressions; ++n) {
    for (int m = 0; m < actual.expressions; ++m) {
      const double scale = std::sqrt(expected[places(n, n)] * expected[places(m, m)]);
      ASSERT_NEAR(matrix(n, m), expected[places(n, m)], kGramRelative * scale)
          << "slot " << slot << ", expressions " << n << " and " << m;
      ASSERT_EQ(matrix(n, m), matrix(m, n)) << "not symmetric";
    }
  }
}

void expectAllSlots(GramProblem& problem) {
  const GramMatrices actual = problem.result();
  const GramSlots& slots = problem.slots;
  expectSlot(actual, slots.whole(), problem.expected(-1, -1));
  for (int k = 0; k < slots.masks; ++k) expectSlot(actual, slots.mask(k), problem.expected(k, -1));
  for (std::size_t j = 0; j < slots.pairs.size(); ++j) {
    expectSlot(actual, slots.pair(static_cast<int>(j)), problem.expected(slots.pairs[j].k, slots.pairs[j].l));
  }
}

struct Case {
  BandShape shape;
  int masks;
  int most_masks;
};

class Gram : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    if (isTooLarge(GetParam().shape)) GTEST_SKIP() << "small sizes only";
  }
};

TEST_P(Gram, EqualsReference) {
  const auto& [shape, masks, most_masks] = GetParam();
  for (const KernelVariant variant : variants()) {
    GramProblem problem(testDevice(), shape, scatteredMasks(shape, masks, most_masks, 4), masks, variant);
    problem.run();
    expectAllSlots(problem);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, Gram,
    testing::Values(Case{{20, 16, 3, 3, SampleType::kUint8}, 3, 2}, Case{{93, 16, 3, 3, SampleType::kUint8}, 5, 3},
                    Case{{93, 10, 1, 1, SampleType::kUint8}, 4, 4}, Case{{40, 16, 4, 5, SampleType::kUint16}, 3, 2},
                    Case{{93, 32, 3, 20, SampleType::kUint8}, 14, 12},
                    Case{{93, 32, 4, 37, SampleType::kFloat32}, 13, 12},
                    Case{{93, 10, 4, 20, SampleType::kUint16}, 9, 8}, Case{{1024, 80, 1, 3, SampleType::kUint8}, 20, 4},
                    Case{{1040, 16, 1, 2, SampleType::kUint8}, 40, 16}));

class GramVariant : public testing::TestWithParam<KernelVariant> {
 protected:
  void SetUp() override {
    if (testDevice().resolve(GetParam()) != GetParam()) GTEST_SKIP() << "the device has one variant only";
  }
};

TEST_P(GramVariant, BandsAndMapsAddUp) {
  if (smallSizesOnly()) GTEST_SKIP() << "small sizes only";
  const BandShape colours{93, 16, 3, 3, SampleType::kUint8};
  const BandShape heights{93, 10, 4, 3, SampleType::kFloat32};
  const BandProblem first(testDevice(), colours, scatteredMasks(colours, 4, 3, 5), 7);
  const BandProblem second(testDevice(), heights, scatteredMasks(heights, 4, 3, 6), 8);
  const GramSlots slots = slotsOf({&first.masks, &second.masks}, 4);
  GramAccumulator accumulator(testDevice(), slots, 3, GetParam());
  accumulator.add(first.tiles, first.differences.buffer(), colours, 1.0);
  accumulator.add(second.tiles, second.differences.buffer(), heights, 0.125);
  const GramMatrices actual = accumulator.finish();
  std::vector<double> expected = reference::gram(gramTiles(first), 3, 3, 2, -1);
  const std::vector<double> more = reference::gram(gramTiles(second), 3, 4, 2, -1);
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += 0.125 * more[i];
  expectSlot(actual, slots.mask(2), expected);

  // finish() starts again from zero.
  accumulator.add(first.tiles, first.differences.buffer(), colours, 1.0);
  expectSlot(accumulator.finish(), slots.whole(), reference::gram(gramTiles(first), 3, 3, -1, -1));
}

TEST_P(GramVariant, EqualExpressionsHaveEqualRowsAndTheSameBitsEveryTime) {
  const BandShape shape{93, 16, 3, 6, SampleType::kUint8};
  if (isTooLarge(shape)) GTEST_SKIP() << "small sizes only";
  GramProblem problem(testDevice(), shape, scatteredMasks(shape, 5, 4, 10), 5, GetParam());
  // Expression 4 (another block than 1) becomes expression 1.
  const auto image = static_cast<std::ptrdiff_t>(problem.samples.size() / 7);
  std::copy_n(problem.samples.begin() + 2 * image, image, problem.samples.begin() + 5 * image);
  problem.computeDifferences();
  problem.run();
  const GramMatrices once = problem.result();
  for (int slot = 0; slot < once.slots.count(); ++slot) {
    const auto matrix = once.slot(slot);
    EXPECT_EQ(matrix(1, 1) + matrix(4, 4) - 2.0 * matrix(1, 4), 0.0) << "slot " << slot;
    for (int m = 0; m < 6; ++m) EXPECT_EQ(matrix(1, m), matrix(4, m)) << "slot " << slot << ", expression " << m;
  }
  problem.run();
  EXPECT_EQ(problem.result().values, once.values);
}

TEST_P(GramVariant, PairsThatAreNotListedAreLeftOut) {
  const BandShape shape{40, 16, 1, 2, SampleType::kUint8};
  const BandProblem band(testDevice(), shape, scatteredMasks(shape, 3, 3, 12));
  GramAccumulator accumulator(testDevice(), GramSlots{3, {{0, 2}}}, 2, GetParam());
  accumulator.add(band.tiles, band.differences.buffer(), shape, 1.0);
  const GramMatrices actual = accumulator.finish();
  const std::vector<reference::GramTile> tiles = gramTiles(band);
  expectSlot(actual, actual.slots.mask(1), reference::gram(tiles, 2, 1, 1, -1));
  expectSlot(actual, actual.slots.pair(0), reference::gram(tiles, 2, 1, 0, 2));
}

/// With little room for partial sums a band takes several launches, over tiles and over blocks; the sums may not
/// change.
TEST_P(GramVariant, LaunchesAddUp) {
  const BandShape shape{1400, 16, 1, 13, SampleType::kUint8};  // 88 places for tiles, 10 blocks
  if (isTooLarge(shape)) GTEST_SKIP() << "small sizes only";
  const TileMasks masks = scatteredMasks(shape, 9, 4, 13);
  GramProblem whole(testDevice(), shape, masks, 9, GetParam());
  whole.run();
  const GramMatrices expected = whole.result();
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{30000}}) {
    GramProblem limited(testDevice(), shape, masks, 9, GetParam(), bytes);
    limited.run();
    const GramMatrices actual = limited.result();
    for (int slot = 0; slot < limited.slots.count(); ++slot) {
      // Two plans are added in double, one by compensated sums on the device: equal but for the last bits of float32.
      ASSERT_TRUE(actual.slot(slot).isApprox(expected.slot(slot), 1e-12)) << bytes << " bytes, slot " << slot;
    }
  }
}

TEST_P(GramVariant, RefusesABufferThatIsTooSmall) {
  const BandShape shape{93, 16, 3, 2, SampleType::kUint8};
  GramProblem problem(testDevice(), shape, scatteredMasks(shape, 3, 1, 2), 3, GetParam());
  const std::size_t bytes = compress::differenceBufferBytes(shape, problem.tileCount());
  const cl::Buffer small = problem.context.allocate(bytes - 1, CL_MEM_READ_WRITE, "differences");
  EXPECT_THROW(problem.accumulator.add(problem.tiles, small, shape, 1.0), DeviceError);
}

INSTANTIATE_TEST_SUITE_P(Variants, GramVariant, testing::Values(KernelVariant::kCpu, KernelVariant::kGpu));

/// A plain float32 sum of these drops every summand but the first.
TEST(GramReduce, CompensatesWhatRoundingDrops) {
  device::DeviceContext& context = testDevice();
  constexpr std::size_t kLanes = 16;
  constexpr int kRows = 1000;
  std::vector<float> partial(kRows * kLanes, 0.03125f);
  std::fill_n(partial.begin(), kLanes, 1e6f);  // half a unit in its last place is 0.03125
  std::vector<cl_int> rows(kRows);
  std::iota(rows.begin(), rows.end(), 0);
  const GuardedBuffer sums(context, kLanes * sizeof(cl_float2));
  context.launch(context.kernel("gram_reduce.cl", "gram_reduce"), device::WorkItems(kLanes, 1).inGroupsOf(kLanes, 1),
                 context.upload(partial, "partial sums"),
                 context.upload(std::vector<cl_int>{0, kRows}, "rows of the slots"), context.upload(rows, "rows"),
                 sums);
  for (const cl_float2 sum : sums.read<cl_float2>()) {
    EXPECT_EQ(static_cast<double>(sum.s[0]) + static_cast<double>(sum.s[1]), 1e6 + 999 * 0.03125);
  }
}

/// What does not fit into a launch goes into the next: every tile is in one plan, whole runs at a time.
TEST(GramPlan, SplitsAtTheLimitOfRows) {
  const BandShape shape{1024, 64, 1, 2, SampleType::kUint8};
  const TileMasks masks = scatteredMasks(shape, 10, 4, 17);
  const GramSlots slots = slotsOf({&masks}, 10);
  const compress::PairSlots pairs(slots);
  compress::DeviceTiles tiles(testDevice());
  tiles.upload(masks);
  const std::size_t all = planGram(tiles, slots, pairs, 0, std::numeric_limits<std::size_t>::max()).rows();
  std::size_t rows = 0;
  int plans = 0;
  for (std::size_t tile = 0; tile < tiles.tileCount(); ++plans) {
    const compress::GramPlan plan = planGram(tiles, slots, pairs, tile, all / 2);
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

}  // namespace
}  // namespace facezip::test
