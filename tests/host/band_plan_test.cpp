#include "compress/band_plan.hpp"

#include <gtest/gtest.h>

namespace facezip {
namespace {

constexpr std::uint64_t kGiB = 1ull << 30;

DeviceInfo deviceWith(std::uint64_t memory, std::uint64_t largest) {
  DeviceInfo info;
  info.name = "test device";
  info.global_memory_bytes = memory;
  info.largest_allocation_bytes = largest;
  return info;
}

compress::BandCost costOf(int width, int expressions) {
  return compress::bandCost({width, 0, 3, expressions, image::SampleType::kUint8}, 4, 60);
}

TEST(BandPlan, StaysWithinMemoryAndIsAMultipleOfTheTile) {
  for (const int width : {93, 1024, 8192}) {
    for (const int expressions : {1, 20, 100}) {
      const compress::BandCost cost = costOf(width, expressions);
      const int rows = compress::planBandRows(cost, 8192, 2 * kGiB, 0, deviceWith(8 * kGiB, 2 * kGiB));
      EXPECT_EQ(rows % 16, 0);
      EXPECT_GE(rows, 16);
      EXPECT_LT(static_cast<std::uint64_t>(rows) * cost.per_row, 2 * kGiB);
    }
  }
}

TEST(BandPlan, DoesNotDependOnTheHeightOfALargeImage) {
  const compress::BandCost cost = costOf(2048, 20);
  const DeviceInfo device = deviceWith(8 * kGiB, 2 * kGiB);
  EXPECT_EQ(compress::planBandRows(cost, 2048, kGiB, 0, device), compress::planBandRows(cost, 8192, kGiB, 0, device));
  EXPECT_EQ(compress::planBandRows(cost, 10, kGiB, 0, device), 16);
}

TEST(BandPlan, SaysHowMuchMemoryIsNeeded) {
  try {
    compress::planBandRows(costOf(8192, 100), 8192, 300u << 20, 0, deviceWith(8 * kGiB, 2 * kGiB));
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.parts().file, "--memory");
    EXPECT_EQ(error.parts().got, "300 MiB");
  }
}

TEST(BandPlan, RowsBesideAndStepsCount) {
  compress::BandCost cost = costOf(2048, 20);
  const DeviceInfo device = deviceWith(8 * kGiB, 2 * kGiB);
  cost.row_step = 1008;
  cost.rows_beside = 128;
  const std::uint64_t needed = (256u << 20) + cost.per_row * (1008 + 128);
  EXPECT_EQ(compress::planBandRows(cost, 2048, needed, 0, device), 1008);
  EXPECT_THROW(compress::planBandRows(cost, 2048, needed - 1, 0, device), InputError);
  EXPECT_EQ(compress::planBandRows(cost, 100, needed, 0, device), 1008);
  const std::uint64_t buffer = cost.largest_buffer_per_row * (1008 + 128);
  EXPECT_NO_THROW(compress::planBandRows(cost, 2048, needed, 0, deviceWith(8 * kGiB, buffer)));
  EXPECT_THROW(compress::planBandRows(cost, 2048, needed, 0, deviceWith(8 * kGiB, buffer - 1)), DeviceError);
}

TEST(BandPlan, RefusesADeviceWithoutRoomForABand) {
  EXPECT_THROW(compress::planBandRows(costOf(8192, 100), 8192, 8 * kGiB, 0, deviceWith(64u << 20, 16u << 20)),
               DeviceError);
}

}  // namespace
}  // namespace facezip
