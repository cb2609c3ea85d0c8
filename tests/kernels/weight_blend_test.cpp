#include "problems/weight_blend.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "facezip/error.hpp"
#include "test_device.hpp"

namespace facezip::test {
namespace {

using device::KernelVariant;

class WeightBlend : public testing::TestWithParam<std::tuple<WeightBlendSizes, KernelVariant>> {
 protected:
  static WeightBlendProblem problem() {
    const auto& [sizes, variant] = GetParam();
    return WeightBlendProblem(testDevice(), sizes, variant);
  }
  /// N rounded additions of terms up to 8 in size.
  static double tolerance(const WeightBlendSizes& sizes) {
    return 8.0 * (sizes.expressions + 2) * 6e-8 * sizes.channels;
  }
};

TEST_P(WeightBlend, AgreesWithTheReference) {
  WeightBlendProblem weights = problem();
  weights.run();
  const std::vector<float> actual = weights.result();
  const std::vector<double> expected = weights.expected();
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t q = 0; q < expected.size(); ++q) {
    ASSERT_NEAR(actual[q], expected[q], tolerance(weights.sizes)) << q;
  }
}

TEST_P(WeightBlend, MultipliesEveryCellByItsGain) {
  WeightBlendProblem weights = problem();
  weights.run();
  const std::vector<float> without = weights.result();
  std::vector<float> gain;
  for (std::size_t cell = 0; cell < weights.on_device.grid().cellCount(); ++cell) {
    gain.push_back(0.25f * static_cast<float>(cell % 9));
  }
  weights.on_device.setGain(gain);
  weights.run();
  const std::vector<float> actual = weights.result();
  const std::vector<double> expected = weights.expected(gain);
  for (std::size_t q = 0; q < expected.size(); ++q) {
    ASSERT_NEAR(actual[q], expected[q], 2.0 * tolerance(weights.sizes)) << q;
  }
  weights.on_device.setGain({});
  weights.run();
  EXPECT_EQ(weights.result(), without);
}

INSTANTIATE_TEST_SUITE_P(Sizes, WeightBlend,
                         testing::Combine(testing::Values(WeightBlendSizes{1, 1, 4, 1}, WeightBlendSizes{12, 8, 4, 5},
                                                          WeightBlendSizes{13, 7, 3, 52}, WeightBlendSizes{5, 9, 8, 2},
                                                          WeightBlendSizes{16, 4, 1, 20}),
                                          testing::Values(KernelVariant::kCpu, KernelVariant::kGpu)));

TEST(WeightMaps, ZeroWeightsGiveZero) {
  WeightBlendProblem weights(testDevice(), {13, 7, 4, 5});
  weights.beta.assign(5, 0.0f);
  weights.run();
  for (const float weight : weights.result()) ASSERT_EQ(weight, 0.0f);
}

TEST(WeightMaps, ARangeOfRowsHasTheBitsOfTheWhole) {
  WeightBlendProblem weights(testDevice(), {13, 9, 4, 5});
  weights.run();
  const std::vector<float> whole = weights.result();
  weights.on_device.blend(std::vector<float>(5, 0.0f));
  weights.on_device.blend(weights.beta, 4, 7);
  const std::vector<float> part = weights.result();
  for (std::size_t q = 4 * 13 * 4; q < 7 * 13 * 4; ++q) ASSERT_EQ(part[q], whole[q]) << q;
}

TEST(RequireWeights, NamesTheExpression) {
  const std::vector<std::string> names = {"smile", "jawOpen"};
  EXPECT_THROW(blend::requireWeights(std::vector<float>{1.0f}, names), InputError);
  try {
    blend::requireWeights(std::vector<float>{1.0f, std::numeric_limits<float>::quiet_NaN()}, names);
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.parts().item, "blendshape weight of jawOpen");
  }
}

}  // namespace
}  // namespace facezip::test
