#include "facezip/blend.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "blend/band_blender.hpp"
#include "blend_frame.hpp"
#include "reference/blend.hpp"
#include "reference/weight_blend.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using test::blendFrame;
using test::SampleMap;
using test::SamplePackage;
using test::testDevice;
using testing::HasSubstr;

double sampleAt(const std::vector<std::byte>& image, SampleType type, std::size_t sample) {
  if (type == SampleType::kUint8) return static_cast<double>(image[sample]);
  if (type == SampleType::kUint16) {
    std::uint16_t value;
    std::memcpy(&value, image.data() + 2 * sample, 2);
    return value;
  }
  float value;
  std::memcpy(&value, image.data() + 4 * sample, 4);
  return static_cast<double>(value);
}

double fullScale(SampleType type) { return type == SampleType::kUint8 ? 255 : type == SampleType::kUint16 ? 65535 : 1; }

/// Codes of a difference texture as numbers.
std::vector<double> differenceCodes(const std::vector<std::byte>& bytes, int bits) {
  const SampleType type = bits == 16 ? SampleType::kUint16 : SampleType::kUint8;
  std::vector<double> codes;
  for (std::size_t s = 0; s < bytes.size() / static_cast<std::size_t>(bits / 8); ++s)
    codes.push_back(sampleAt(bytes, type, s));
  return codes;
}

std::vector<unsigned char> toCodes(const std::vector<std::byte>& bytes) {
  const auto* begin = reinterpret_cast<const unsigned char*>(bytes.data());
  return {begin, begin + bytes.size()};
}

/// What a frame of the format is made of.
struct Parts {
  reference::Textures textures;
  reference::WeightMaps weights;
};

Parts partsOf(const SamplePackage& sample, std::size_t m) {
  const PackageDescription& d = sample.description;
  const PackageMap& map = d.maps[m];
  reference::Textures textures{
      map.width, map.height, map.channels, d.differences, map.weight_scale, fullScale(map.sample_type), {}, {}, {}, {}};
  const std::size_t samples = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height * map.channels);
  for (std::size_t s = 0; s < samples; ++s)
    textures.neutral.push_back(sampleAt(sample.neutrals[m], map.sample_type, s));
  for (std::size_t i = 0; i < map.differences.size(); ++i) {
    textures.codes.push_back(differenceCodes(sample.differences[m][i], map.difference_bits));
    textures.scale.push_back(map.differences[i].scale);
    textures.offset.push_back(map.differences[i].offset);
  }
  const std::size_t set = static_cast<std::size_t>(map.weight_set);
  const PackageWeights& w = d.weights[set];
  const reference::WeightMaps weights{
      w.tile_width, w.tile_height, d.differences, static_cast<int>(d.expressions.size()), toCodes(sample.weights[set]),
      w.scale,      w.offset};
  return {textures, weights};
}

/// Map `m` of the sample, blended in double by the words of the format.
std::vector<double> expectedFrame(const SamplePackage& sample, std::size_t m, const std::vector<float>& beta) {
  const Parts parts = partsOf(sample, m);
  return reference::blendFrame(parts.textures, reference::blendWeights(parts.weights, beta), parts.weights.columns,
                               parts.weights.rows);
}

/// How far a frame may be off, by the words of the format: every term by its size.
std::vector<double> allowedErrors(const SamplePackage& sample, std::size_t m, std::vector<float> beta) {
  Parts parts = partsOf(sample, m);
  // A 256th of a code of each difference texture, times the weights as they are.
  reference::Textures steps = parts.textures;
  std::ranges::fill(steps.neutral, 0.0);
  for (std::size_t i = 0; i < steps.codes.size(); ++i) {
    std::ranges::fill(steps.codes[i], std::ldexp(1.0, -8));
    std::ranges::fill(steps.offset[i], 0.0);
  }
  std::vector<double> weights = reference::blendWeights(parts.weights, beta);
  for (double& weight : weights) weight = std::abs(weight);
  const std::vector<double> of_codes = reference::blendFrame(steps, weights, parts.weights.columns, parts.weights.rows);
  double k = parts.textures.differences + 16;
  for (float& b : beta) {
    k += b != 0.0f ? 1 : 0;
    b = std::abs(b);
  }
  if (const int s = parts.textures.weight_scale; (s & (s - 1)) != 0) {
    k += 2 * std::max(parts.weights.columns, parts.weights.rows);
  }
  for (double& offset : parts.weights.offset) offset = std::abs(offset);
  for (double& value : parts.textures.neutral) value = std::abs(value);
  const auto channels = static_cast<std::size_t>(parts.textures.channels);
  for (std::size_t i = 0; i < parts.textures.codes.size(); ++i) {
    for (std::size_t s = 0; s < parts.textures.codes[i].size(); ++s) {
      double& code = parts.textures.codes[i][s];
      code = std::abs(parts.textures.scale[i][s % channels] * code + parts.textures.offset[i][s % channels]);
    }
    parts.textures.scale[i].assign(channels, 1.0);
    parts.textures.offset[i].assign(channels, 0.0);
  }
  std::vector<double> errors = reference::blendFrame(parts.textures, reference::blendWeights(parts.weights, beta),
                                                     parts.weights.columns, parts.weights.rows);
  for (std::size_t s = 0; s < errors.size(); ++s) errors[s] = k * std::ldexp(1.0, -24) * errors[s] + of_codes[s];
  return errors;
}

std::vector<float> someWeights(std::size_t expressions) {
  std::vector<float> beta;
  for (std::size_t n = 0; n < expressions; ++n)
    beta.push_back(std::sin(1.0f + static_cast<float>(n)) / static_cast<float>(expressions));
  return beta;
}

struct FrameCase {
  SampleMap map;
  int expressions;
  int differences = 4;
};

class BlenderFrames : public testing::TestWithParam<FrameCase> {
 protected:
  BlenderFrames() : sample_(test::makeSample({GetParam().map}, GetParam().expressions, GetParam().differences)) {
    test::writeSample(sample_, folder_ / "package");
    package_ = std::make_unique<Package>(Package::open(folder_ / "package"));
  }
  test::TemporaryDirectory folder_;
  SamplePackage sample_;
  std::unique_ptr<Package> package_;
};

TEST_P(BlenderFrames, AgreeWithTheReference) {
  Blender blender(*package_, testDevice());
  const std::vector<float> beta = someWeights(package_->expressions().size());
  const std::vector<std::byte> frame = blendFrame(blender, *package_, 0, beta);
  const std::vector<double> expected = expectedFrame(sample_, 0, beta);
  const SampleType type = GetParam().map.type;
  // Float sums of N weights and C differences: a few units of 2^-24 of the largest term.
  const double slack = 1e-5 * fullScale(type);
  for (std::size_t s = 0; s < expected.size(); ++s) {
    const double got = sampleAt(frame, type, s);
    if (type == SampleType::kFloat32) {
      ASSERT_NEAR(got, expected[s], slack) << s;
    } else {
      const auto rounded = [&](double value) { return std::clamp(std::floor(value + 0.5), 0.0, fullScale(type)); };
      ASSERT_TRUE(got >= rounded(expected[s] - slack) && got <= rounded(expected[s] + slack))
          << s << ": " << expected[s] << " gave " << got;
    }
  }
}

/// Weights far beyond 1 sum to large numbers that may cancel.
TEST_P(BlenderFrames, KeepToTheStatedToleranceAtAnyWeight) {
  Blender blender(*package_, testDevice());
  for (const float size : {0.05f, 1.0f, 40.0f, 1000.0f}) {
    std::vector<float> beta = someWeights(package_->expressions().size());
    for (float& b : beta) b *= size * static_cast<float>(beta.size());
    const std::vector<std::byte> frame = blendFrame(blender, *package_, 0, beta);
    const std::vector<double> expected = expectedFrame(sample_, 0, beta), allowed = allowedErrors(sample_, 0, beta);
    const SampleType type = GetParam().map.type;
    for (std::size_t s = 0; s < expected.size(); ++s) {
      const double got = sampleAt(frame, type, s);
      if (type == SampleType::kFloat32) {
        ASSERT_NEAR(got, expected[s], allowed[s]) << s;
      } else {
        const auto rounded = [&](double value) { return std::clamp(std::floor(value + 0.5), 0.0, fullScale(type)); };
        ASSERT_TRUE(got >= rounded(expected[s] - allowed[s]) && got <= rounded(expected[s] + allowed[s]))
            << s << ": " << expected[s] << " gave " << got << " at " << size;
      }
    }
  }
}

TEST_P(BlenderFrames, ZeroWeightsGiveTheNeutralBitForBit) {
  Blender blender(*package_, testDevice());
  std::vector<std::byte> frame(package_->maps()[0].frameBytes());
  blender.blend(0, frame);  // before any setWeights
  EXPECT_EQ(frame, sample_.neutrals[0]);
  blendFrame(blender, *package_, 0, someWeights(package_->expressions().size()));
  EXPECT_EQ(blendFrame(blender, *package_, 0, std::vector<float>(package_->expressions().size(), 0.0f)),
            sample_.neutrals[0]);
}

TEST_P(BlenderFrames, BandsHaveTheBitsOfTheWhole) {
  const PackageMap& map = package_->maps()[0];
  Blender blender(*package_, testDevice());
  blend::BandBlender bands(*package_, 0, blend::loadWeightMaps(*package_, testDevice()), testDevice());
  std::vector<float> one_hot(package_->expressions().size(), 0.0f);
  one_hot.back() = 1.0f;
  for (const std::vector<float>& beta : {someWeights(package_->expressions().size()), one_hot}) {
    const std::vector<std::byte> whole = blendFrame(blender, *package_, 0, beta);
    const std::size_t row_bytes = whole.size() / static_cast<std::size_t>(map.height);
    for (const int rows : {8, 24}) {
      std::vector<std::byte> joined;
      for (int begin = 0; begin < map.height; begin += rows) {
        const int end = std::min(begin + rows, map.height);
        std::vector<std::byte> band(static_cast<std::size_t>(end - begin) * row_bytes);
        bands.loadRows(begin, end);
        bands.blend(beta, band);
        joined.insert(joined.end(), band.begin(), band.end());
      }
      EXPECT_EQ(joined, whole) << rows;
    }
  }
}

TEST_P(BlenderFrames, AreTheValuesBeforeRounding) {
  const PackageMap& map = package_->maps()[0];
  blend::BandBlender bands(*package_, 0, blend::loadWeightMaps(*package_, testDevice()), testDevice());
  const std::vector<float> beta = someWeights(package_->expressions().size());
  const std::vector<double> expected = expectedFrame(sample_, 0, beta);
  std::vector<float> values(expected.size());
  std::vector<std::byte> frame(map.frameBytes());
  bands.loadRows(0, map.height);
  bands.blendValues(beta, values);
  bands.blend(beta, frame);  // one after the other on the same rows
  const double full_scale = fullScale(map.sample_type);
  for (std::size_t s = 0; s < expected.size(); ++s) {
    const double value = static_cast<double>(values[s]) * full_scale / 255.0;
    ASSERT_NEAR(value, expected[s], 1e-5 * full_scale) << s;
    const bool rounded = map.sample_type != SampleType::kFloat32;
    ASSERT_NEAR(sampleAt(frame, map.sample_type, s), rounded ? std::clamp(value, 0.0, full_scale) : value,
                rounded ? 0.5 + 1e-5 * full_scale : 1e-6)
        << s;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, BlenderFrames,
                         testing::Values(FrameCase{{"m", 93, 61, 3, SampleType::kUint8, 8}, 5},
                                         FrameCase{{"m", 93, 61, 1, SampleType::kUint8, 4}, 1},
                                         FrameCase{{"m", 93, 61, 4, SampleType::kUint8, 16}, 52},
                                         FrameCase{{"m", 93, 61, 3, SampleType::kUint16, 4}, 5},
                                         FrameCase{{"m", 93, 61, 1, SampleType::kUint16, 8}, 52},
                                         FrameCase{{"m", 93, 61, 3, SampleType::kFloat32, 8}, 1},
                                         FrameCase{{"m", 93, 61, 1, SampleType::kFloat32, 16}, 5},
                                         FrameCase{{"m", 64, 64, 3, SampleType::kUint8, 8}, 20},
                                         FrameCase{{"m", 1, 1, 3, SampleType::kUint8, 8}, 1},
                                         FrameCase{{"m", 7, 300, 4, SampleType::kFloat32, 1}, 2},
                                         FrameCase{{"m", 41, 23, 3, SampleType::kUint8, 8}, 5, 1},
                                         FrameCase{{"m", 41, 23, 3, SampleType::kUint8, 8}, 5, 3},
                                         FrameCase{{"m", 41, 23, 3, SampleType::kUint8, 8}, 5, 5},
                                         FrameCase{{"m", 41, 23, 3, SampleType::kUint8, 8}, 5, 8},
                                         FrameCase{{"m", 41, 23, 3, SampleType::kUint8, 8, 0, 16}, 5, 4},
                                         FrameCase{{"m", 41, 23, 1, SampleType::kUint8, 4, 0, 16}, 5, 1},
                                         FrameCase{{"m", 41, 23, 2, SampleType::kUint16, 4, 0, 16}, 3, 8},
                                         FrameCase{{"m", 41, 23, 4, SampleType::kFloat32, 8, 0, 16}, 2, 5}));

TEST(Blender, IsLinearBeforeRounding) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = test::makeSample({{"m", 40, 24, 3, SampleType::kFloat32, 8}}, 2);
  test::writeSample(sample, folder.path());
  const Package package = Package::open(folder.path());
  Blender blender(package, testDevice());
  const std::vector<std::byte> neutral = blendFrame(blender, package, 0, {0, 0}),
                               a = blendFrame(blender, package, 0, {0.5f, 0});
  const std::vector<std::byte> b = blendFrame(blender, package, 0, {0, 0.25f}),
                               both = blendFrame(blender, package, 0, {0.5f, 0.25f});
  for (std::size_t s = 0; s < 40 * 24 * 3; ++s) {
    const auto at = [s](const std::vector<std::byte>& frame) { return sampleAt(frame, SampleType::kFloat32, s); };
    ASSERT_NEAR(at(both) - at(neutral), at(a) + at(b) - 2 * at(neutral), 2e-6) << s;
  }
}

TEST(Blender, BlendsEveryMapWithItsWeightsAndManyFrames) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = test::makeSample({{"albedo", 40, 24, 3, SampleType::kUint8, 8, 0},
                                           {"height", 37, 21, 1, SampleType::kUint8, 4, 1, 16},
                                           {"normal", 80, 48, 3, SampleType::kUint16, 16, 0}});
  test::writeSample(sample, folder.path());
  const Package package = Package::open(folder.path());
  Blender first(package, testDevice());
  Blender blender = std::move(first);
  for (int frame = 0; frame < 5; ++frame) {
    std::vector<float> beta(5, 0.0f);
    beta[static_cast<std::size_t>(frame)] = 0.7f;
    for (const int m : {0, 1, 2}) {
      const std::vector<std::byte> got = blendFrame(blender, package, m, beta);
      const std::vector<double> expected = expectedFrame(sample, static_cast<std::size_t>(m), beta);
      const SampleType type = package.maps()[static_cast<std::size_t>(m)].sample_type;
      for (std::size_t s = 0; s < expected.size(); ++s) {
        ASSERT_NEAR(sampleAt(got, type, s), std::clamp(expected[s], 0.0, fullScale(type)), 0.6)
            << frame << " " << m << " " << s;
      }
    }
  }
}

TEST(Blender, RefusesWrongCountsAndNumbers) {
  const test::TemporaryDirectory folder;
  SamplePackage sample = test::makeSample();
  test::writeSample(sample, folder.path());
  const Package package = Package::open(folder.path());
  Blender blender(package, testDevice());
  std::vector<std::byte> frame(package.maps()[0].frameBytes());
  EXPECT_THROW(blender.setWeights(std::vector<float>(4, 0.0f)), InputError);
  EXPECT_THROW(blender.setWeights(std::vector<float>{0, 0, std::numeric_limits<float>::infinity(), 0, 0}), InputError);
  EXPECT_THROW(blender.blend(1, frame), InputError);
  EXPECT_THROW(blender.blend(-1, frame), InputError);
  EXPECT_THROW(blender.blend(0, std::span(frame).first(frame.size() - 1)), InputError);
  blend::BandBlender bands(package, 0, blend::loadWeightMaps(package, testDevice()), testDevice());
  bands.loadRows(0, 24);
  std::vector<float> values(40 * 24 * 3);
  EXPECT_THROW(bands.blendValues(std::vector<float>(4, 0.0f), values), InputError);
  EXPECT_THROW(bands.blendValues(std::vector<float>{0, 0, std::nanf(""), 0, 0}, values), InputError);
}

TEST(Blender, DamageInsideAnImageNamesTheFile) {
  for (const char* name : {"weights.png", "albedo/neutral.png", "albedo/difference_2.png"}) {
    const test::TemporaryDirectory folder;
    SamplePackage sample = test::makeSample();
    test::writeSample(sample, folder.path());
    {
      std::fstream file(folder / name, std::ios::in | std::ios::out | std::ios::binary);
      const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(folder / name) / 2);
      file.seekp(middle);
      file.write("damaged!", 8);
    }
    try {
      const Package package = Package::open(folder.path());
      Blender blender(package, testDevice());
      ADD_FAILURE() << "expected an InputError for " << name;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
  }
}

}  // namespace
}  // namespace facezip
