#include "compress/bands/difference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "canary_buffer.hpp"
#include "reference/difference.hpp"
#include "synthetic_band.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

using image::SampleType;

class Difference : public testing::TestWithParam<BandShape> {};

std::vector<double> run(const test::SyntheticBand& band, const TileMasks& masks) {
  device::DeviceContext& context = test::testDevice();
  DeviceTiles tiles(context);
  tiles.upload(masks);
  const cl::Buffer samples = context.upload(band.samples, "samples");
  const test::CanaryBuffer differences(context, differenceBufferBytes(band.shape, masks.tiles.size()));
  computeDifferences(context, tiles, band.shape, samples, differences.buffer());
  context.finish();
  if (band.shape.differenceBytes() == 2) {
    const std::vector<cl_short> values = differences.read<cl_short>();
    return {values.begin(), values.end()};
  }
  const std::vector<float> values = differences.read<float>();
  return {values.begin(), values.end()};
}

TEST_P(Difference, EqualsReference) {
  const BandShape& shape = GetParam();
  if (test::smallSizesOnly() && shape.expressions > 3) GTEST_SKIP() << "small sizes only";
  const test::SyntheticBand band = test::makeBand(shape, 1);
  const TileMasks masks = test::makeTileMasks(shape, 3, 1, 2);
  const std::vector<double> actual = run(band, masks);
  const std::vector<double> expected =
      reference::differences(band.values, test::tilePositions(masks), shape.width, shape.rows, shape.channels,
                             shape.expressions, static_cast<double>(image::unit255(shape.sample_type)));
  ASSERT_EQ(actual.size(), expected.size());
  const double tolerance = shape.sample_type == SampleType::kUint8 ? 0.0 : 2.0 * 255.0 * test::kDifferenceRelative;
  for (std::size_t i = 0; i < actual.size(); ++i) ASSERT_NEAR(actual[i], expected[i], tolerance) << "at " << i;
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, Difference,
    testing::Values(BandShape{93, 16, 3, 3, SampleType::kUint8}, BandShape{93, 10, 1, 1, SampleType::kUint8},
                    BandShape{93, 32, 4, 3, SampleType::kUint8}, BandShape{64, 16, 2, 2, SampleType::kUint8},
                    BandShape{93, 32, 3, 20, SampleType::kUint8}, BandShape{93, 10, 3, 3, SampleType::kUint16},
                    BandShape{7, 1, 4, 3, SampleType::kUint16}, BandShape{144, 32, 1, 37, SampleType::kUint16},
                    BandShape{93, 16, 1, 3, SampleType::kFloat32}, BandShape{93, 10, 3, 3, SampleType::kFloat32},
                    BandShape{93, 32, 4, 20, SampleType::kFloat32}));

TEST(Difference, BandWithoutTilesDoesNothing) {
  device::DeviceContext& context = test::testDevice();
  DeviceTiles tiles(context);
  TileMasks none;
  none.mask_begin = {0};
  tiles.upload(none);
  const BandShape shape{16, 16, 3, 1, SampleType::kUint8};
  const cl::Buffer empty = context.allocate(1, CL_MEM_READ_WRITE, "empty");
  EXPECT_NO_THROW(computeDifferences(context, tiles, shape, empty, empty));
}

TEST(Difference, RefusesBuffersThatAreTooSmall) {
  device::DeviceContext& context = test::testDevice();
  const BandShape shape{93, 16, 3, 2, SampleType::kUint8};
  const TileMasks masks = test::makeTileMasks(shape, 3, 1, 2);
  DeviceTiles tiles(context);
  tiles.upload(masks);
  const std::size_t bytes = differenceBufferBytes(shape, masks.tiles.size());
  const cl::Buffer samples = context.allocate(shape.sampleBytes(), CL_MEM_READ_ONLY, "samples");
  const cl::Buffer few_samples = context.allocate(shape.sampleBytes() - 1, CL_MEM_READ_ONLY, "samples");
  const cl::Buffer out = context.allocate(bytes, CL_MEM_READ_WRITE, "differences");
  const cl::Buffer small_out = context.allocate(bytes - 1, CL_MEM_READ_WRITE, "differences");
  EXPECT_THROW(computeDifferences(context, tiles, shape, few_samples, out), DeviceError);
  EXPECT_THROW(computeDifferences(context, tiles, shape, samples, small_out), DeviceError);
}

}  // namespace
}  // namespace facezip::compress
