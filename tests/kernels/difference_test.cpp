#include "problems/difference.hpp"

#include <gtest/gtest.h>

#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using image::SampleType;

class Difference : public testing::TestWithParam<BandShape> {};

TEST_P(Difference, EqualsReference) {
  const BandShape& shape = GetParam();
  if (smallSizesOnly() && shape.expressions > 3) GTEST_SKIP() << "small sizes only";
  DifferenceProblem problem(testDevice(), shape, scatteredMasks(shape, 3, 1, 2));
  problem.run();
  const std::vector<double> actual = problem.result();
  const std::vector<double>& expected = problem.expected();
  ASSERT_EQ(actual.size(), expected.size());
  const double tolerance = shape.sample_type == SampleType::kUint8 ? 0.0 : 2.0 * 255.0 * kDifferenceRelative;
  for (std::size_t i = 0; i < actual.size(); ++i) ASSERT_NEAR(actual[i], expected[i], tolerance) << "at " << i;
}

// Each type of samples and each number of channels is a program; sizes are free.
INSTANTIATE_TEST_SUITE_P(
    Shapes, Difference,
    testing::Values(BandShape{93, 16, 3, 3, SampleType::kUint8}, BandShape{93, 10, 1, 1, SampleType::kUint8},
                    BandShape{93, 32, 4, 3, SampleType::kUint8}, BandShape{64, 16, 2, 2, SampleType::kUint8},
                    BandShape{93, 32, 3, 20, SampleType::kUint8}, BandShape{93, 10, 3, 3, SampleType::kUint16},
                    BandShape{7, 1, 3, 3, SampleType::kUint16}, BandShape{144, 32, 1, 37, SampleType::kUint16},
                    BandShape{93, 16, 1, 3, SampleType::kFloat32}, BandShape{93, 10, 1, 3, SampleType::kFloat32},
                    BandShape{93, 32, 4, 20, SampleType::kFloat32}));

/// Beyond the region's border: integers are rounded, to even where two are as near.
TEST_P(Difference, FadesEqualReference) {
  const BandShape& shape = GetParam();
  if (smallSizesOnly() && shape.expressions > 3) GTEST_SKIP() << "small sizes only";
  TileMasks masks = scatteredMasks(shape, 3, 1, 2);
  Hashed hashed(5);
  for (std::size_t i = 0; i < masks.texel_weights.size(); ++i) {
    masks.fades.push_back(i % 7 == 0 ? 0.0f : i % 5 == 0 ? 1.0f : hashed.between(0.0f, 1.0f));
  }
  DifferenceProblem problem(testDevice(), shape, masks);
  problem.run();
  const std::vector<double> actual = problem.result();
  const std::vector<double>& expected = problem.expected();
  ASSERT_EQ(actual.size(), expected.size());
  const bool integers = shape.sample_type == SampleType::kUint8;
  const double tolerance = integers ? 0.5 + 1e-4 : 2.0 * 255.0 * kDifferenceRelative;
  for (std::size_t i = 0; i < actual.size(); ++i) ASSERT_NEAR(actual[i], expected[i], tolerance) << "at " << i;
}

TEST(Difference, BandWithoutTilesDoesNothing) {
  device::DeviceContext& context = testDevice();
  compress::DeviceTiles tiles(context);
  TileMasks none;
  none.mask_begin = {0};
  tiles.upload(none);
  const BandShape shape{16, 16, 3, 1, SampleType::kUint8};
  const cl::Buffer empty = context.allocate(1, CL_MEM_READ_WRITE, "empty");
  EXPECT_NO_THROW(compress::computeDifferences(context, tiles, shape, empty, empty));
}

TEST(Difference, RefusesBuffersThatAreTooSmall) {
  const BandShape shape{93, 16, 3, 2, SampleType::kUint8};
  const BandProblem band(testDevice(), shape, scatteredMasks(shape, 3, 1, 2));
  const auto buffer = [&](std::size_t bytes) { return band.context.allocate(bytes, CL_MEM_READ_WRITE, "too small"); };
  EXPECT_THROW(compress::computeDifferences(band.context, band.tiles, shape, buffer(shape.sampleBytes() - 1),
                                            band.differences.buffer()),
               DeviceError);
  const std::size_t bytes = compress::differenceBufferBytes(shape, band.tileCount());
  EXPECT_THROW(compress::computeDifferences(band.context, band.tiles, shape, band.device_samples, buffer(bytes - 1)),
               DeviceError);
}

}  // namespace
}  // namespace facezip::test
