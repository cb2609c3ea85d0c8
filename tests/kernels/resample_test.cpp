#include "problems/resample.hpp"

#include <gtest/gtest.h>

#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using image::SampleType;

class Resample : public testing::TestWithParam<ResampleSizes> {};

TEST_P(Resample, EqualsReference) {
  const ResampleSizes& sizes = GetParam();
  if (smallSizesOnly() && sizes.count > 400) GTEST_SKIP() << "small sizes only";
  ResampleProblem problem(testDevice(), sizes);
  problem.run();
  const std::vector<float> samples = problem.result();
  float untouched = 0.0f;
  std::memset(&untouched, 0xA5, sizeof(untouched));
  for (std::size_t i = 0; i < sizes.count; ++i) {
    for (int c = 0; c < sizes.channels; ++c) {
      const float sample = samples[i * toSize(sizes.channels) + toSize(c)];
      if (!problem.isPlace(i)) {
        ASSERT_EQ(std::memcmp(&sample, &untouched, sizeof(sample)), 0) << "no place, yet written: " << i;
        continue;
      }
      ASSERT_NEAR(double{sample}, problem.expected(i, c), kResampleRelative * problem.fullScale()) << i << ", " << c;
    }
  }
}

// Each type of samples and each number of channels is a program; sizes are free.
INSTANTIATE_TEST_SUITE_P(Sizes, Resample,
                         testing::Values(ResampleSizes{1, 1, 3, SampleType::kUint8, 7},
                                         ResampleSizes{7, 93, 3, SampleType::kUint8, 333},
                                         ResampleSizes{144, 93, 3, SampleType::kUint8, 4096},
                                         ResampleSizes{31, 7, 1, SampleType::kUint16, 144},
                                         ResampleSizes{64, 64, 4, SampleType::kUint16, 1000},
                                         ResampleSizes{17, 5, 2, SampleType::kFloat32, 93},
                                         ResampleSizes{93, 144, 1, SampleType::kFloat32, 4097}));

TEST(ResampleTexture, GivesATexelBackAtItsCentreAndKeepsWhatHasNoPlace) {
  image::Image texture{{2, 2, 1, SampleType::kUint8}, {std::byte{10}, std::byte{20}, std::byte{30}, std::byte{40}}};
  registration::TextureSampler sampler(testDevice(), texture);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> samples = {-1, -1, -1, -7};
  sampler.sample(std::vector<float>{1, 0, 0, 1, 0.5f, 0.5f, nan, nan}, samples);
  EXPECT_EQ(samples, (std::vector<float>{20, 30, 25, -7}));
}

TEST(ResampleTexture, BuffersThatAreTooSmallAreRefused) {
  ResampleProblem problem(testDevice(), {16, 16, 3, SampleType::kUint8, 64});
  registration::ResampleLaunch launch = problem.launch;
  launch.height = 17;
  EXPECT_THROW(registration::launchResample(testDevice(), launch), DeviceError);
  launch = problem.launch;
  launch.count = 100000;
  EXPECT_THROW(registration::launchResample(testDevice(), launch), DeviceError);
}

}  // namespace
}  // namespace facezip::test
