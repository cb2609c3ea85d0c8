#include "compress/best_neutral.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "facezip/compress.hpp"
#include "facezip/package.hpp"
#include "kind_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using image::ImageShape;
using image::SampleType;
using test::noise;

constexpr int kExpressions = 5;

/// Noise of each scan's own, and a change of the left third; neutral first, in units of 1/255.
double sample(int image, int x, int y, int c) {
  const double changed = image > 0 && x < 16 ? 20.0 : 0.0;
  return 100.0 + x + 2.0 * noise(x, y, c, image) + changed;
}

template <typename Sample>
std::vector<std::byte> samplesOf(const ImageShape& shape, double unit) {
  std::vector<Sample> values;
  for (int image = 0; image <= kExpressions; ++image) {
    for (int y = 0; y < shape.height; ++y) {
      for (int x = 0; x < shape.width; ++x) {
        for (int c = 0; c < shape.channels; ++c) {
          const double value = sample(image, x, y, c) * unit;
          values.push_back(static_cast<Sample>(std::is_floating_point_v<Sample> ? value : std::round(value)));
        }
      }
    }
  }
  std::vector<std::byte> bytes(values.size() * sizeof(Sample));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

template <typename Sample>
void expectMeans(const ImageShape& shape, double unit) {
  const std::vector<std::byte> before = samplesOf<Sample>(shape, unit);
  compress::StillSkin skin(shape, kExpressions);
  const std::size_t row = shape.rowBytes();
  const auto band = [&](const std::vector<std::byte>& all, int begin, int end) {
    std::vector<std::byte> rows;
    for (int image = 0; image <= kExpressions; ++image) {
      const auto first = all.begin() + static_cast<std::ptrdiff_t>((image * shape.height + begin) * row);
      rows.insert(rows.end(), first, first + static_cast<std::ptrdiff_t>((end - begin) * row));
    }
    return rows;
  };
  for (int begin = 0; begin < shape.height; begin += 16) {
    const int end = std::min(begin + 16, shape.height);
    skin.look(begin, end, band(before, begin, end));
  }
  skin.finish();
  std::vector<std::byte> after = before;
  skin.apply(0, shape.height, after);
  EXPECT_TRUE(std::equal(before.begin() + static_cast<std::ptrdiff_t>(shape.height * row), before.end(),
                         after.begin() + static_cast<std::ptrdiff_t>(shape.height * row)))
      << "expressions stay";
  const auto* was = reinterpret_cast<const Sample*>(before.data());
  const auto* is = reinterpret_cast<const Sample*>(after.data());
  const std::size_t samples = static_cast<std::size_t>(shape.height) * row / sizeof(Sample);
  const double rounding = std::is_floating_point_v<Sample> ? 1e-6 : 0.5 + 1e-9;
  for (std::size_t i = 0; i < samples; ++i) {
    const int x = static_cast<int>(i) / shape.channels % shape.width;
    double mean = 0.0;
    for (int image = 0; image <= kExpressions; ++image) {
      mean += static_cast<double>(was[static_cast<std::size_t>(image) * samples + i]) / (kExpressions + 1);
    }
    if (x < 16) {  // its blocks change
      ASSERT_EQ(is[i], was[i]) << i;
    } else if (x >= 28) {  // from the centre of the first block that is inside
      ASSERT_NEAR(static_cast<double>(is[i]), mean, rounding) << i;
    } else {
      const double least = std::min(mean, static_cast<double>(was[i])),
                   most = std::max(mean, static_cast<double>(was[i]));
      ASSERT_GE(static_cast<double>(is[i]), least - rounding) << i;
      ASSERT_LE(static_cast<double>(is[i]), most + rounding) << i;
    }
  }
  for (int begin = 0; begin < shape.height; begin += 7) {
    const int end = std::min(begin + 7, shape.height);
    std::vector<std::byte> rows = band(before, begin, end);
    skin.apply(begin, end, rows);
    ASSERT_EQ(rows, band(after, begin, end));
  }
}

TEST(StillSkin, IsTheMeanOfAllScans) {
  expectMeans<std::uint8_t>({45, 37, 3, SampleType::kUint8}, 1.0);
  expectMeans<std::uint16_t>({45, 37, 1, SampleType::kUint16}, 257.0);
  expectMeans<float>({45, 37, 2, SampleType::kFloat32}, 1.0 / 255.0);
}

TEST(StillSkin, OfOneBlockAndOfNone) {
  const ImageShape shape{5, 3, 1, SampleType::kUint8};
  std::vector<std::byte> samples(2 * 15, std::byte{10});
  for (std::size_t i = 15; i < 30; ++i) samples[i] = std::byte{12};
  compress::StillSkin skin(shape, 1);
  skin.look(0, 3, samples);
  skin.finish();
  EXPECT_EQ(skin.share(), 1.0);
  skin.apply(0, 3, samples);
  EXPECT_EQ(samples[0], std::byte{11});
  for (std::size_t i = 15; i < 30; ++i) samples[i] = std::byte{20};
  compress::StillSkin changed(shape, 1);
  changed.look(0, 3, samples);
  changed.finish();
  EXPECT_EQ(changed.share(), 0.0);
}

TEST(BestNeutral, LowersTheErrorOfExpressions) {
  const test::TemporaryDirectory folder;
  const auto difference = [](int x, int y, int c, int n) {
    return 4.0 * noise(x, y, c, n) - 4.0 * noise(x, y, c, 99) + (x < 60 ? test::wrinkles(x, y, c, n) : 0.0);
  };
  test::writeCapture(folder / "c", {"noisy", 12, 160, 160, SampleType::kUint8, difference});
  const auto compressed = [&](NeutralTexture neutral) {
    CompressOptions options;
    options.unit = "m";
    options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
    options.differences = 3;
    options.restarts = 10;
    options.cluster_restarts = 8;
    options.neutral_texture = neutral;
    Progress progress;
    return compressCapture(openCapture(folder / "c"), folder / nameOf(neutral), options, test::testDevice(), progress);
  };
  const double captured = compressed(NeutralTexture::kCaptured).rmse[0].second;
  const double best = compressed(NeutralTexture::kBest).rmse[0].second;
  EXPECT_LT(best, 0.97 * captured);
  const image::Image scan = image::readImage(folder / "c/albedo/neutral.png");
  EXPECT_EQ(image::readImage(folder / "captured/albedo/neutral.png").samples, scan.samples);
  const image::Image cleaned = image::readImage(folder / "best/albedo/neutral.png");
  EXPECT_NE(cleaned.samples, scan.samples);
  // Where wrinkles are, the neutral is the scan's.
  const auto at = [&](const image::Image& image, int x, int y) {
    return image.samples[static_cast<std::size_t>((y * 160 + x) * 3)];
  };
  EXPECT_EQ(at(cleaned, 30, 40), at(scan, 30, 40));
}

}  // namespace
}  // namespace facezip
