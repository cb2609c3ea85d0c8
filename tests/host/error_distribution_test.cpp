#include "evaluate/error_distribution.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace facezip {
namespace {
using evaluate::ErrorDistribution;

TEST(ErrorDistribution, OfNothingIsZero) {
  const ErrorDistribution none;
  EXPECT_EQ(none.count(), 0u);
  EXPECT_EQ(none.mean(), 0.0);
  EXPECT_EQ(none.rootMeanSquare(), 0.0);
  EXPECT_EQ(none.quantile(0.99), 0.0);
  EXPECT_EQ(none.max(), 0.0);
}

TEST(ErrorDistribution, GivesMeanRootMeanSquareAndMax) {
  ErrorDistribution errors;
  errors.add(std::vector<float>{3.0f, 4.0f});
  errors.add(std::vector<float>{0.0f, 5.0f});
  EXPECT_EQ(errors.count(), 4u);
  EXPECT_DOUBLE_EQ(errors.mean(), 3.0);
  EXPECT_DOUBLE_EQ(errors.rootMeanSquare(), std::sqrt(50.0 / 4.0));
  EXPECT_EQ(errors.max(), 5.0);
}

TEST(ErrorDistribution, CountsWhatIsBeyondALimit) {
  ErrorDistribution errors;
  errors.add(std::vector<float>{7.99f, 8.0f, 31.0f, 32.0f, 1000.0f});
  EXPECT_EQ(errors.beyond(0), 5u);
  EXPECT_EQ(errors.beyond(8), 4u);
  EXPECT_EQ(errors.beyond(32), 2u);
  EXPECT_EQ(errors.beyond(256), 1u);
  EXPECT_EQ(ErrorDistribution().beyond(8), 0u);
}

TEST(ErrorDistribution, QuantileIsTheUpperEdgeOfItsBin) {
  ErrorDistribution errors;
  std::vector<float> values;
  for (int i = 0; i < 1000; ++i) values.push_back(0.01f * static_cast<float>(i));  // 0 to 9.99
  errors.add(values);
  // 990 values do not pass 9.89, which lies between 632/64 and 633/64.
  EXPECT_EQ(errors.quantile(0.99), 633.0 / 64.0);
  EXPECT_EQ(errors.quantile(0.5), 320.0 / 64.0);  // 4.99
  EXPECT_EQ(errors.quantile(1.0), static_cast<double>(values.back()));
}

TEST(ErrorDistribution, ExactValuesStayExact) {
  ErrorDistribution errors;
  errors.add(std::vector<float>(100, 0.0f));
  EXPECT_EQ(errors.quantile(0.99), 0.0);
  errors.add(std::vector<float>{7.25f});
  EXPECT_EQ(errors.quantile(0.99), 1.0 / 64.0);
  EXPECT_EQ(errors.max(), 7.25);
}

TEST(ErrorDistribution, ErrorsAboveTheHistogramKeepTheirMax) {
  ErrorDistribution errors;
  errors.add(std::vector<float>{1.0f, 300.0f, 1e30f});
  EXPECT_EQ(errors.max(), static_cast<double>(1e30f));
  EXPECT_EQ(errors.quantile(0.3), 65.0 / 64.0);
  EXPECT_EQ(errors.quantile(0.99), errors.max());
}

TEST(ErrorDistribution, PartsAddUpToTheWhole) {
  ErrorDistribution whole, first, second;
  for (int i = 0; i < 500; ++i) {
    const std::vector<float> value = {std::fmod(0.37f * static_cast<float>(i), 11.0f)};
    whole.add(value);
    (i < 200 ? first : second).add(value);
  }
  first.add(second);
  EXPECT_EQ(first.count(), whole.count());
  EXPECT_EQ(first.quantile(0.99), whole.quantile(0.99));
  EXPECT_EQ(first.max(), whole.max());
  EXPECT_NEAR(first.rootMeanSquare(), whole.rootMeanSquare(), 1e-12);
}

}  // namespace
}  // namespace facezip
