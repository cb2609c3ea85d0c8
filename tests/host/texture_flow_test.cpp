#include "flow/texture_flow.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "register/flow_points.hpp"

namespace facezip {
namespace {

constexpr int kSide = 160;

/// Skin of pores and spots, with values at any place.
float skin(double x, double y) {
  double value = 0.5;
  for (int wave = 0; wave < 24; ++wave) {
    const double angle = 2.4 * wave, length = 5.0 + 0.9 * wave;
    value += 0.03 * std::cos(2.0 * M_PI * (x * std::cos(angle) + y * std::sin(angle)) / length + 1.7 * wave);
  }
  return static_cast<float>(value);
}

/// How far the second picture is moved, in texels.
double movedX(double x, double y) { return 1.8 + 0.8 * std::sin(0.03 * x + 0.02 * y); }
double movedY(double x, double y) { return -1.1 + 0.6 * std::cos(0.025 * x - 0.03 * y); }

struct Picture {
  std::vector<float> grey = std::vector<float>(kSide * kSide, 0.0f);
  std::vector<std::uint8_t> known = std::vector<std::uint8_t>(kSide * kSide, 1);
  flow::GreyPicture view() const { return {kSide, kSide, grey, known}; }
};

template <typename Value>
Picture pictureOf(Value&& value) {
  Picture picture;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) picture.grey[static_cast<std::size_t>(y * kSide + x)] = value(x, y);
  }
  return picture;
}

Picture still() { return pictureOf(skin); }
/// Shows at x what the still one shows at x - moved(x).
Picture moved() {
  return pictureOf([](double x, double y) { return skin(x - movedX(x, y), y - movedY(x, y)); });
}

/// Mean error of the flow from moved() to still() over texels that `wanted` takes.
template <typename Wanted>
double errorOf(const flow::TextureFlow& flow, Wanted&& wanted) {
  double sum = 0.0;
  int count = 0;
  for (int y = 12; y < kSide - 12; ++y) {
    for (int x = 12; x < kSide - 12; ++x) {
      if (!wanted(x, y)) continue;
      const float* vector = &flow.forward[static_cast<std::size_t>(2 * (y * kSide + x))];
      sum += std::hypot(double{vector[0]} + movedX(x, y), double{vector[1]} + movedY(x, y));
      ++count;
    }
  }
  return sum / count;
}
constexpr auto kEverywhere = [](int, int) { return true; };

TEST(TextureFlow, FindsHowSkinSlid) {
  const Picture from = moved(), to = still();
  const flow::TextureFlow flow = flow::flowBetween(from.view(), to.view());
  ASSERT_EQ(flow.forward.size(), 2u * kSide * kSide);
  EXPECT_LT(errorOf(flow, kEverywhere), 0.15);
  EXPECT_EQ(flow::flowBetween(from.view(), to.view()).forward, flow.forward);
}

TEST(TextureFlow, LightAndBloodDoNotPull) {
  const Picture from = moved(),
                to = pictureOf([](double x, double y) {
                  const double blush = 0.15 * std::exp(-((x - 90) * (x - 90) + (y - 60) * (y - 60)) / 900.0);
                  return static_cast<float>(0.6 * skin(x, y) + 0.1 + 0.001 * x - blush);
                });
  EXPECT_LT(errorOf(flow::flowBetween(from.view(), to.view()), kEverywhere), 0.2);
}

TEST(TextureFlow, WhatIsNotKnownDoesNotPull) {
  const auto hole = [](int x, int y) { return std::hypot(x - 80, y - 80) < 20.0; };
  Picture from = moved(), to = still();
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (!hole(x, y)) continue;
      from.known[static_cast<std::size_t>(y * kSide + x)] = 0;
      from.grey[static_cast<std::size_t>(y * kSide + x)] = 1.0f;
    }
  }
  const auto around = [&](int x, int y) { return !hole(x, y) && std::hypot(x - 80, y - 80) < 40.0; };
  EXPECT_LT(errorOf(flow::flowBetween(from.view(), to.view()), around), 0.4);
}

TEST(TextureFlow, WhatOnePictureAloneShowsIsNotBelieved) {
  const auto fold = [](int x, int y) { return std::hypot(x - 80, y - 80) < 18.0; };
  const Picture from = moved();
  const Picture to = pictureOf([&](int x, int y) { return fold(x, y) ? skin(3 * y + 500, 2 * x) : skin(x, y); });
  const flow::TextureFlow flow = flow::flowBetween(from.view(), to.view());
  double inside = 0.0, outside = 0.0;
  int count_inside = 0, count_outside = 0;
  for (int y = 20; y < kSide - 20; ++y) {
    for (int x = 20; x < kSide - 20; ++x) {
      const double distance = std::hypot(x - 80, y - 80), trust = flow::trustOf(flow, x, y);
      if (distance < 12.0) inside += trust, ++count_inside;
      if (distance > 40.0) outside += trust, ++count_outside;
    }
  }
  EXPECT_GT(outside / count_outside, 0.9);
  EXPECT_LT(inside / count_inside, 0.5);
  EXPECT_TRUE(std::isinf(flow::missedBy(flow, kSide - 1, kSide - 1)));
}

/// Two triangles over a layout of 64 texels a side, half a millimetre each; everything flows by 2 texels to the right.
struct Layout {
  static constexpr int kTexels = 64;
  std::vector<raster::TexelSample> texels{kTexels * kTexels};
  std::vector<std::uint8_t> known = std::vector<std::uint8_t>(kTexels * kTexels, 1);
  registration::TexelPlaces places{kTexels * kTexels, 3};
  flow::TextureFlow flow{kTexels, kTexels, std::vector<float>(2 * kTexels * kTexels, 0.0f),
                         std::vector<float>(2 * kTexels * kTexels, 0.0f), std::vector<float>(kTexels* kTexels, 1.0f)};

  Layout() {
    for (int y = 0; y < kTexels; ++y) {
      for (int x = 0; x < kTexels; ++x) {
        const auto at = static_cast<std::size_t>(y * kTexels + x);
        texels[at].triangle = y < 32 ? 0 : 1;
        texels[at].b0 = static_cast<float>(x) / kTexels;
        places.row(static_cast<Eigen::Index>(at)) << 0.5 * x, 0.5 * y, 7.0;
        flow.forward[2 * at] = 2.0f;
        flow.backward[2 * at] = -2.0f;
      }
    }
  }
  std::vector<geometry::SkinPoint> points() const {
    return registration::flowPoints(flow, texels, known, places, 2, 0.5);
  }
};

TEST(FlowPoints, PointWhereTheTextureOfATriangleLies) {
  const std::vector<geometry::SkinPoint> points = Layout().points();
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].triangle, 1);
  // Texels 0 to 60 of a row end inside of the picture: on average at column 30, which flows to 32.
  EXPECT_NEAR(points[0].barycentric[0], 30.0 / Layout::kTexels, 1e-6);
  EXPECT_NEAR(points[0].target.x(), 0.5 * 32.0, 1e-6);
  EXPECT_NEAR(points[0].target.z(), 7.0, 1e-9);
  EXPECT_GT(points[0].trust, 0.9);
}

TEST(FlowPoints, FlowThatDoesNotComeBackMakesNone) {
  Layout layout;
  for (std::size_t i = 0; i < layout.flow.backward.size() / 2; i += 2) layout.flow.backward[i] = 1.0f;  // triangle 0
  const std::vector<geometry::SkinPoint> points = layout.points();
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].triangle, 1);
}

TEST(FlowPoints, NothingFlowsAcrossAGapOrToWhatWasNotSeen) {
  Layout gap;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (x % 2 == 0) gap.places(y * 64 + x, 2) += 30.0;  // the other lip in every second column
    }
  }
  EXPECT_EQ(gap.points().size(), 1u);
  Layout unseen;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; x += 2) unseen.places.row(y * 64 + x).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_EQ(unseen.points().size(), 1u);
  Layout unknown;
  std::fill_n(unknown.known.begin(), 32 * 64, std::uint8_t{0});
  EXPECT_EQ(unknown.points().size(), 1u);
}

}  // namespace
}  // namespace facezip
