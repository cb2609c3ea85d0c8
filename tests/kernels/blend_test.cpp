#include "problems/blend.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using device::KernelVariant;
using image::SampleType;

// A program is compiled for every number of channels and textures, scale, type and bits: sizes that differ in nothing
// else cost little.
const BlendSizes kSizes[] = {{93, 61, 3, 4, 8, SampleType::kUint8},
                             {64, 48, 3, 4, 8, SampleType::kUint8},
                             {1, 1, 3, 4, 8, SampleType::kUint8},
                             {512, 300, 3, 4, 8, SampleType::kUint8},
                             {93, 61, 4, 4, 4, SampleType::kUint8},
                             {35, 19, 4, 4, 4, SampleType::kUint8},
                             {64, 48, 4, 8, 8, SampleType::kUint8},
                             {33, 40, 3, 5, 5, SampleType::kUint8},
                             {37, 21, 3, 5, 5, SampleType::kUint8},
                             {50, 50, 3, 4, 100, SampleType::kUint8},
                             {64, 16, 2, 3, 2, SampleType::kUint8},
                             {93, 61, 1, 4, 16, SampleType::kUint8},
                             {93, 61, 3, 4, 8, SampleType::kUint16},
                             {32, 32, 2, 4, 24, SampleType::kUint16},
                             {93, 61, 1, 1, 3, SampleType::kUint16},
                             {93, 61, 3, 4, 8, SampleType::kFloat32},
                             {35, 19, 3, 4, 8, SampleType::kFloat32},
                             {93, 61, 4, 2, 6, SampleType::kFloat32},
                             {37, 21, 3, 4, 8, SampleType::kUint8, 16},
                             {17, 9, 2, 3, 1, SampleType::kUint8, 16},
                             {37, 21, 4, 5, 8, SampleType::kUint16, 16},
                             {37, 21, 1, 3, 5, SampleType::kFloat32, 16},
                             {37, 21, 3, 4, 8, SampleType::kUint8, 16, true},
                             {21, 17, 4, 2, 4, SampleType::kUint8, 8, true}};
/// Of every type and number of channels, with codes in quads and not.
const BlendSizes kValueSizes[] = {
    {93, 61, 3, 4, 8, SampleType::kUint8},          {1, 1, 3, 4, 8, SampleType::kUint8},
    {35, 19, 4, 4, 4, SampleType::kUint8},          {37, 21, 3, 5, 5, SampleType::kUint8},
    {93, 61, 1, 4, 16, SampleType::kUint8},         {93, 61, 3, 4, 8, SampleType::kUint16},
    {35, 19, 3, 4, 8, SampleType::kFloat32},        {17, 9, 2, 3, 1, SampleType::kUint8, 16},
    {37, 21, 4, 5, 8, SampleType::kUint16, 16},     {37, 21, 1, 3, 5, SampleType::kFloat32, 16},
    {37, 21, 3, 4, 8, SampleType::kUint8, 16, true}};

class Blend : public testing::TestWithParam<std::tuple<BlendSizes, KernelVariant>> {
 protected:
  void SetUp() override {
    const auto& [size, variant] = GetParam();
    if (smallSizesOnly() && (size.width > 50 || size.differences > 5)) GTEST_SKIP() << "large for a simulator";
    // Oclgrind's shadow values of swizzles are read out of bounds when a lane is unused. The arithmetic is seen in the
    // other types, the packing on every other device.
    const bool oclgrind = testDevice().info().platform == "Oclgrind";
    if (oclgrind && variant == KernelVariant::kCpu && size.channels == 3 && size.type == SampleType::kUint8) {
      GTEST_SKIP() << "Oclgrind 21.10 --uninitialized crashes on the swizzles that pack RGB8";
    }
  }
  static BlendProblem problem() {
    const auto& [sizes, variant] = GetParam();
    return BlendProblem(testDevice(), sizes, variant);
  }
};
class BlendValues : public Blend {};

/// What rounding half up may give where float arithmetic puts the value within `slack` of `exact`.
bool roundsTo(double exact, double full_scale, double slack, double got) {
  const double low = std::clamp(std::floor(exact - slack + 0.5), 0.0, full_scale);
  const double high = std::clamp(std::floor(exact + slack + 0.5), 0.0, full_scale);
  return got >= low && got <= high;
}

/// What the bias of codes, where frames have it folded, may add to their error: weights are 1 at most.
double biasSlack(const BlendProblem& problem) {
  const bool narrow = problem.sizes.type == SampleType::kUint8 && problem.sizes.difference_bits == 8;
  if (!problem.context.clangBuiltins(problem.variant) || !narrow) return 0.0;
  double most = 0.0;
  for (std::size_t c = 0; c < toSize(problem.sizes.channels); ++c) {
    double sum = 0.0;
    for (const std::vector<double>& of_texture : problem.code_scale) sum += of_texture[c];
    most = std::max(most, sum);
  }
  return kFoldedCodeBias * most;
}

void expectAgreement(const BlendProblem& problem) {
  const std::vector<double> expected = problem.expected();
  const std::vector<std::byte> frame = problem.blendRows(0, problem.sizes.height);
  // Terms reach 1.5 of full scale each; float arithmetic loses a few units of 2^-24 in each.
  const double slack = 3e-6 * problem.fullScale() + biasSlack(problem);
  for (std::size_t s = 0; s < expected.size(); ++s) {
    const double got = problem.sampleAt(frame, s);
    if (problem.sizes.type == SampleType::kFloat32) {
      ASSERT_NEAR(got, expected[s], slack) << s;
    } else {
      ASSERT_TRUE(roundsTo(expected[s], problem.fullScale(), slack, got))
          << s << ": " << expected[s] << " gave " << got;
    }
  }
}

TEST_P(Blend, AgreesWithTheReference) { expectAgreement(problem()); }

TEST_P(Blend, ZeroWeightsGiveTheNeutralBitForBit) {
  const BlendProblem scene = problem();
  if (scene.sizes.wide_neutral) {
    const std::vector<std::byte> frame = scene.blendRows(0, scene.sizes.height, 0.0f);
    for (std::size_t s = 0; s < frame.size(); ++s) {
      ASSERT_EQ(scene.sampleAt(frame, s), std::round(scene.neutralAt(s))) << s;
    }
    return;
  }
  EXPECT_EQ(scene.blendRows(0, scene.sizes.height, 0.0f), scene.neutral);
}

TEST_P(Blend, BandsHaveTheBitsOfTheWhole) {
  const BlendProblem scene = problem();
  const int height = scene.sizes.height;
  std::vector<std::byte> bands;
  for (int begin = 0; begin < height; begin += 24) {
    const std::vector<std::byte> band = scene.blendRows(begin, std::min(begin + 24, height));
    bands.insert(bands.end(), band.begin(), band.end());
  }
  EXPECT_EQ(bands, scene.blendRows(0, height));
}

TEST_P(BlendValues, AreTheReferenceNeitherRoundedNorClamped) {
  const BlendProblem scene = problem();
  const std::vector<double> expected = scene.expected();
  const std::vector<float> values = scene.blendValues(0, scene.sizes.height);
  const double unit = 255.0 / scene.fullScale();
  ASSERT_EQ(values.size(), expected.size());
  double lowest = 0.0, highest = 0.0;
  for (std::size_t s = 0; s < expected.size(); ++s) {
    const double value = static_cast<double>(values[s]);
    ASSERT_NEAR(value, expected[s] * unit, 3e-6 * 255.0) << s;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  if (values.size() < 100) return;
  EXPECT_LT(lowest, -1.0);
  EXPECT_GT(highest, scene.sizes.type == SampleType::kFloat32 ? 254.0 : 256.0);
}

TEST_P(BlendValues, OfZeroWeightsAreTheNeutral) {
  const BlendProblem scene = problem();
  const std::vector<float> values = scene.blendValues(0, scene.sizes.height, 0.0f);
  for (std::size_t s = 0; s < values.size(); ++s) {
    const double expected = scene.neutralAt(s) * 255.0 / scene.fullScale();
    if (scene.sizes.type == SampleType::kUint8 && !scene.sizes.wide_neutral) {
      ASSERT_EQ(static_cast<double>(values[s]), expected) << s;
    } else {
      ASSERT_NEAR(static_cast<double>(values[s]), expected, 3e-7 * 255.0) << s;
    }
  }
}

TEST_P(BlendValues, OfABandHaveTheBitsOfTheWhole) {
  const BlendProblem scene = problem();
  if (scene.sizes.height <= 24) GTEST_SKIP() << "one band";
  std::vector<float> values = scene.blendValues(0, scene.sizes.height);
  values.erase(values.begin(), values.begin() + std::ptrdiff_t{24} * scene.sizes.width * scene.sizes.channels);
  EXPECT_EQ(scene.blendValues(24, scene.sizes.height), values);
}

const auto kVariants = testing::Values(KernelVariant::kCpu, KernelVariant::kGpu);
INSTANTIATE_TEST_SUITE_P(Sizes, Blend, testing::Combine(testing::ValuesIn(kSizes), kVariants));
INSTANTIATE_TEST_SUITE_P(Sizes, BlendValues, testing::Combine(testing::ValuesIn(kValueSizes), kVariants));

/// The device of the tests under another platform's name: kernels keep to OpenCL C.
device::DeviceContext& plainDevice() {
  static device::DeviceContext& context = *[] {
    DeviceInfo info = testDevice().info();
    info.platform = "another";
    return new device::DeviceContext(testDevice().device(), info);
  }();
  return context;
}

TEST(Blend, NeedsNoBuiltinsOfClang) {
  if (!testDevice().clangBuiltins(KernelVariant::kCpu)) GTEST_SKIP() << "nothing else is tested here";
  for (const BlendSizes& sizes : {kSizes[0], kSizes[5], kSizes[8]}) {
    const BlendProblem scene(plainDevice(), sizes, KernelVariant::kCpu);
    expectAgreement(scene);
    EXPECT_EQ(scene.blendRows(0, sizes.height, 0.0f), scene.neutral);
  }
}

TEST(Blend, VariantsAgreeToTheRounding) {
  const BlendSizes sizes{64, 48, 3, 4, 8, SampleType::kFloat32};
  const BlendProblem cpu(testDevice(), sizes, KernelVariant::kCpu);
  const BlendProblem gpu(testDevice(), sizes, KernelVariant::kGpu);
  const std::vector<std::byte> cpu_frame = cpu.blendRows(0, sizes.height);
  const std::vector<std::byte> gpu_frame = gpu.blendRows(0, sizes.height);
  for (std::size_t s = 0; s < cpu.samples(); ++s) {
    ASSERT_NEAR(cpu.sampleAt(cpu_frame, s), cpu.sampleAt(gpu_frame, s), 3e-6);
  }
}

TEST(CellRowsOf, CoversWhatTheRowsInterpolateBetween) {
  for (const int s : {1, 2, 3, 7, 8, 16, 61, 100}) {
    const int height = 1373, cells = divideUp(height, s);
    for (int begin = 0; begin < height; begin += 8) {
      const int end = std::min(begin + 8, height);
      const raster::CellRows rows = raster::cellRowsOf(begin, end, s, cells);
      const double top = std::clamp((begin + 0.5) / s - 0.5, 0.0, cells - 1.0);
      const double bottom = std::clamp((end - 0.5) / s - 0.5, 0.0, cells - 1.0);
      EXPECT_LE(rows.begin, static_cast<int>(std::floor(top)));
      EXPECT_GT(rows.end, static_cast<int>(std::ceil(bottom)));
      EXPECT_GE(rows.begin, 0);
      EXPECT_LE(rows.end, cells);
      // And no more than the next row.
      EXPECT_GE(rows.begin + 1, static_cast<int>(std::floor(top)));
      EXPECT_LE(rows.end, static_cast<int>(std::floor(bottom)) + 2);
    }
  }
}

}  // namespace
}  // namespace facezip::test
