#include "evaluate/normal_angle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace facezip {
namespace {

/// A normal as the three values of a texel, and a fourth channel that must not count.
std::vector<float> texelOf(double x, double y, double z) {
  const auto value = [](double v) { return static_cast<float>(127.5 * (v + 1.0)); };
  return {value(x), value(y), value(z), 77.0f};
}

double angleBetween(const std::vector<float>& a, const std::vector<float>& b) {
  std::vector<float> angle(1);
  evaluate::normalAngles(a, b, 4, std::vector<std::uint32_t>{0}, angle);
  return static_cast<double>(angle[0]);
}

TEST(NormalAngle, IsThatOfUnitVectors) {
  EXPECT_NEAR(angleBetween(texelOf(0, 0, 1), texelOf(0, 0, 1)), 0.0, 1e-6);
  EXPECT_NEAR(angleBetween(texelOf(0, 0, 1), texelOf(1, 0, 0)), 90.0, 1e-4);
  EXPECT_NEAR(angleBetween(texelOf(0, 0, 1), texelOf(0, 0, -1)), 180.0, 1e-4);
  EXPECT_NEAR(angleBetween(texelOf(0, 0, 0.5), texelOf(0.5, 0, 0.5)), 45.0, 1e-4) << "lengths do not count";
  const double tilt = 0.01 * std::acos(-1.0) / 180.0;
  EXPECT_NEAR(angleBetween(texelOf(0, 0, 1), texelOf(std::sin(tilt), 0, std::cos(tilt))), 0.01, 1e-4);
}

TEST(NormalAngle, AVectorWithoutDirectionCountsAsTheNeutralAxis) {
  EXPECT_NEAR(angleBetween(texelOf(0, 0, 0), texelOf(0, 0, 1)), 0.0, 1e-4);
  EXPECT_NEAR(angleBetween(texelOf(0, 0, 0), texelOf(0, 1, 0)), 90.0, 1e-4);
}

TEST(NormalAngle, MapsAreKnownByNameAndChannels) {
  for (const char* name : {"normal", "normals", "Normal_world", "detailNormal"}) {
    EXPECT_TRUE(evaluate::isNormalMap(name, 3)) << name;
    EXPECT_TRUE(evaluate::isNormalMap(name, 4)) << name;
    EXPECT_FALSE(evaluate::isNormalMap(name, 2)) << name;
  }
  EXPECT_FALSE(evaluate::isNormalMap("albedo", 3));
}

}  // namespace
}  // namespace facezip
