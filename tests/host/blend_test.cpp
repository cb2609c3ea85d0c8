#include "facezip/blend.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "blend/band_blender.hpp"
#include "blend/names.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "reference/blend.hpp"
#include "reference/weight_blend.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
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

/// Map `m` of the sample, blended in double by the words of the format.
std::vector<double> expectedFrame(const SamplePackage& sample, std::size_t m, const std::vector<float>& beta) {
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
  return reference::blendFrame(textures, reference::blendWeights(weights, beta), w.tile_width, w.tile_height);
}

std::vector<float> someWeights(std::size_t expressions) {
  std::vector<float> beta;
  for (std::size_t n = 0; n < expressions; ++n)
    beta.push_back(std::sin(1.0f + static_cast<float>(n)) / static_cast<float>(expressions));
  return beta;
}

std::vector<std::byte> blendFrame(Blender& blender, const Package& package, int map, const std::vector<float>& beta) {
  std::vector<std::byte> frame(package.maps()[static_cast<std::size_t>(map)].frameBytes());
  blender.setWeights(beta);
  blender.blend(map, frame);
  return frame;
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

/// An image of equal rows.
image::Image grayRows(int width, int height, int channels, const std::vector<int>& row,
                      SampleType type = SampleType::kUint8) {
  image::Image image{{width, height, channels, type}, {}};
  for (int y = 0; y < height; ++y) {
    for (const int code : row) {
      const auto wide = static_cast<std::uint16_t>(code);
      const auto bytes = std::as_bytes(std::span(&wide, 1));  // little-endian, as every OpenCL device today
      image.samples.insert(image.samples.end(), bytes.begin(), bytes.begin() + image::sampleBytes(type));
    }
  }
  return image;
}

/// One row of what a renderer sees of a map before rounding.
std::vector<float> valuesOfRow0(const Package& package, int map, const std::vector<float>& beta) {
  const PackageMap& described = package.maps()[static_cast<std::size_t>(map)];
  blend::BandBlender bands(package, map, blend::loadWeightMaps(package, testDevice()), testDevice());
  bands.loadRows(0, described.height);
  std::vector<float> values(static_cast<std::size_t>(described.height * described.width * described.channels));
  bands.blendValues(beta, values);
  values.resize(static_cast<std::size_t>(described.width * described.channels));
  return values;
}

/// The images of the worked example of docs/package_format.md.
void writeExampleImages(const std::filesystem::path& folder) {
  io::createDirectories(folder / "albedo");
  image::writeImage(folder / "albedo/weights.png",
                    grayRows(8, 3, 2, {255, 128, 255, 128, 0, 128, 0, 128, 0, 192, 0, 192, 255, 64, 255, 64}));
  std::vector<int> neutral;
  for (int x = 0; x < 16; ++x) neutral.push_back(100 + x);
  image::writeImage(folder / "albedo/neutral.png", grayRows(16, 8, 1, neutral));
  image::writeImage(folder / "albedo/difference_0.png", grayRows(16, 8, 1, std::vector<int>(16, 148)));
  image::writeImage(folder / "albedo/difference_1.png", grayRows(16, 8, 1, std::vector<int>(16, 118)));
  io::createDirectories(folder / "gloss");
  image::writeImage(folder / "gloss/weights.png",
                    grayRows(6, 3, 2, {128, 64, 128, 64, 128, 64, 64, 32, 64, 32, 64, 32}));
  image::writeImage(folder / "gloss/neutral.png", grayRows(4, 2, 1, std::vector<int>(4, 50)));
  image::writeImage(folder / "gloss/difference_0.png",
                    grayRows(4, 2, 1, std::vector<int>(4, 35349), SampleType::kUint16));
  image::writeImage(folder / "gloss/difference_1.png",
                    grayRows(4, 2, 1, {20000, 20300, 20600, 20900}, SampleType::kUint16));
}

constexpr char kExampleJson[] = R"({
  "format": "facezip-package", "version": 2, "generator": "by hand", "name": "example",
  "expressions": ["smile", "jawOpen"], "differences": 2,
  "weights": [
    {"files": ["albedo/weights.png"], "columns": 2, "rows": 1, "tile_width": 2, "tile_height": 1, "border": 1,
     "scale": [0.00392156862745098, 0.0078125], "offset": [0, -1]},
    {"files": ["gloss/weights.png"], "columns": 2, "rows": 1, "tile_width": 1, "tile_height": 1, "border": 1,
     "scale": [0.0078125, 0.0078125], "offset": [0, 0]}],
  "maps": [
    {"name": "albedo", "width": 16, "height": 8, "channels": 1, "sample_type": "8-bit", "colour_space": "sRGB",
     "weights": 0, "weight_scale": 8, "metric_weight": 1, "neutral": {"file": "albedo/neutral.png"},
     "difference_bits": 8,
     "differences": [{"file": "albedo/difference_0.png", "scale": [0.5], "offset": [-64]},
                     {"file": "albedo/difference_1.png", "scale": [1.0], "offset": [-128]}]},
    {"name": "gloss", "width": 4, "height": 2, "channels": 1, "sample_type": "8-bit", "colour_space": "linear",
     "weights": 1, "weight_scale": 4, "metric_weight": 1, "neutral": {"file": "gloss/neutral.png"},
     "difference_bits": 16,
     "differences": [{"file": "gloss/difference_0.png", "scale": [0.00390625], "offset": [-128]},
                     {"file": "gloss/difference_1.png", "scale": [0.00390625], "offset": [0]}]}],
  "method": {}})";

// The worked example of docs/package_format.md: its JSON, images and numbers, without facezip's writer.
TEST(PackageFormat, WorkedExampleGivesItsTestVectors) {
  const test::TemporaryDirectory folder;
  io::writeTextFile(folder / "package.json", kExampleJson);
  writeExampleImages(folder.path());
  const Package package = Package::open(folder.path());
  Blender blender(package, testDevice());
  const std::vector<int> albedo = {100, 101, 102, 103, 105, 108, 111, 114, 116, 119, 122, 125, 127, 128, 129, 130};
  EXPECT_EQ(blendFrame(blender, package, 0, {0.5f, 1.0f}), grayRows(16, 8, 1, albedo).samples);
  EXPECT_THAT(valuesOfRow0(package, 0, {0.5f, 1.0f}),
              testing::Pointwise(testing::FloatNear(1e-4f),
                                 {100.0f, 101.0f, 102.0f, 103.0f, 104.9375f, 107.8125f, 110.6875f, 113.5625f, 116.4375f,
                                  119.3125f, 122.1875f, 125.0625f, 127.0f, 128.0f, 129.0f, 130.0f}));
  const std::vector<std::byte> neutral = image::readImage(folder / "albedo/neutral.png").samples;
  EXPECT_EQ(blendFrame(blender, package, 0, {0.0f, 0.0f}), neutral);
  EXPECT_EQ(blendFrame(blender, package, 0, {100.0f, 0.0f})[0], std::byte{255});
  EXPECT_NEAR(valuesOfRow0(package, 0, {100.0f, 0.0f})[0], 1100.0f, 1e-3f);
  EXPECT_EQ(blendFrame(blender, package, 0, {-100.0f, 0.0f})[0], std::byte{0});
  EXPECT_NEAR(valuesOfRow0(package, 0, {-100.0f, 0.0f})[0], -900.0f, 1e-3f);
  EXPECT_EQ(blendFrame(blender, package, 1, {0.5f, 1.0f}), grayRows(4, 2, 1, {99, 100, 100, 101}).samples);
  EXPECT_THAT(
      valuesOfRow0(package, 1, {0.5f, 1.0f}),
      testing::Pointwise(testing::FloatNear(1e-5f), {99.14453125f, 99.73046875f, 100.31640625f, 100.90234375f}));
}

Package packageOf(const test::TemporaryDirectory& folder, const std::vector<std::string>& expressions) {
  SamplePackage sample = test::makeSample({{}}, static_cast<int>(expressions.size()));
  sample.description.expressions = expressions;
  test::writeSample(sample, folder / "package");
  return Package::open(folder / "package");
}

TEST(WeightsByName, FillsInZerosAndRefusesTheUnknown) {
  const test::TemporaryDirectory folder;
  const Package package = packageOf(folder, {"smile", "jawOpen", "jawLeft", "browUp"});
  EXPECT_EQ(weightsByName(package, {{"jawLeft", 0.5f}, {"smile", -1.0f}}),
            (std::vector<float>{-1.0f, 0.0f, 0.5f, 0.0f}));
  EXPECT_EQ(weightsByName(package, {}), std::vector<float>(4, 0.0f));
  EXPECT_THROW(weightsByName(package, {{"smile", 1.0f}, {"smile", 1.0f}}), InputError);
  EXPECT_THROW(weightsByName(package, {{"smile", std::nanf("")}}), InputError);
  try {
    weightsByName(package, {{"JawOpne", 1.0f}});
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"JawOpne\"; the nearest are jawOpen, "));
  }
}

TEST(EditDistance, CountsEditsSwapsAndNotCase) {
  EXPECT_EQ(blend::editDistance("", "abc"), 3);
  EXPECT_EQ(blend::editDistance("kitten", "sitting"), 3);
  EXPECT_EQ(blend::editDistance("JAWOPEN", "jawOpen"), 0);
  EXPECT_EQ(blend::editDistance("jawOpne", "jawOpen"), 1);
}

TEST(ParseWeights, ReadsPairsAndQuotesWhatItCannot) {
  using Pairs = std::vector<std::pair<std::string, float>>;
  EXPECT_EQ(parseWeights(" smile = 0.7 ,jawOpen=-2e-1"), (Pairs{{"smile", 0.7f}, {"jawOpen", -0.2f}}));
  EXPECT_EQ(parseWeights("a=b=1"), (Pairs{{"a=b", 1.0f}}));
  EXPECT_TRUE(parseWeights("  ").empty());
  for (const char* text :
       {"smile", "smile=", "=1", "smile=x", "smile=1,", "smile=1 2", "smile=nan", "smile=1e99", "smile=0,7"}) {
    EXPECT_THROW(parseWeights(text), InputError) << text;
  }
}

class Animation : public testing::Test {
 protected:
  Animation() : package_(packageOf(folder_, {"smile", "jawOpen", "browUp"})) {}
  AnimationClip read(const std::string& text) {
    io::writeTextFile(folder_ / "clip.csv", text);
    return readAnimation(folder_ / "clip.csv", package_);
  }
  std::string messageOf(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "expected an InputError for " << text;
    return "";
  }
  test::TemporaryDirectory folder_;
  Package package_;
};

TEST_F(Animation, MapsColumnsToExpressions) {
  const AnimationClip clip = read("\xef\xbb\xbfTime, browUp,\"smile\"\r\n0, 0.5,1\r\n\r\n1,+0.25,-1\r\n");
  ASSERT_EQ(clip.frames(), 2);
  EXPECT_THAT(clip.frame(0), testing::ElementsAre(1.0f, 0.0f, 0.5f));
  EXPECT_THAT(clip.frame(1), testing::ElementsAre(-1.0f, 0.0f, 0.25f));
}

TEST_F(Animation, NamesFileLineAndColumn) {
  EXPECT_THAT(messageOf("smile\n0.5\nx\n"),
              HasSubstr("clip.csv: line 3, column 1: expected a finite number, got \"x\""));
  EXPECT_THAT(messageOf("smile,frown\n1,2\n"), HasSubstr("line 1, column 2"));
  EXPECT_THAT(messageOf("smile,smile\n1,2\n"), HasSubstr("line 1, column 2: expected each expression once"));
  EXPECT_THAT(messageOf("smile,jawOpen\n1\n"), HasSubstr("line 2: expected 2 columns, got 1"));
  EXPECT_THAT(messageOf("smile\ninf\n"), HasSubstr("line 2, column 1"));
  EXPECT_THAT(messageOf("smile\n\n"), HasSubstr("a header alone"));
  EXPECT_THAT(messageOf(""), HasSubstr("an empty file"));
  EXPECT_THROW(readAnimation(folder_ / "none.csv", package_), InputError);
  EXPECT_THROW(readAnimation(folder_.path(), package_), InputError);
}

}  // namespace
}  // namespace facezip
