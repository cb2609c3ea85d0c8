// Packages with textures in blocks: written by compressing, read by all that reads packages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "blocks/texture_file.hpp"
#include "coded_afterwards.hpp"
#include "facezip/compress.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/reconstruct.hpp"
#include "file_contents.hpp"
#include "io/folder.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using test::testDevice;
namespace fs = std::filesystem;

CompressOptions smallOptions(std::optional<BlockFormat> format = {}) {
  CompressOptions options;
  options.unit = "m";
  options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
  options.restarts = 10;
  options.cluster_restarts = 8;
  options.texture_format = format;
  return options;
}

double rmse(const Capture& capture, const fs::path& package) {
  Progress progress;
  return evaluatePackage(capture, Package::open(package), {}, testDevice(), progress).maps[0].rmse.at("package").pooled;
}

/// Keeps what is noted.
class Notes : public Progress {
 public:
  void note(std::string_view message) override { all.emplace_back(message); }
  std::vector<std::string> all;
};

class BlockPackage : public testing::TestWithParam<BlockFormat> {};

TEST_P(BlockPackage, IsSmallAndNearCapture) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 9});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  compressCapture(capture, folder / "images", smallOptions(), testDevice(), progress);
  compressCapture(capture, folder / "blocks", smallOptions(GetParam()), testDevice(), progress);
  const Package package = Package::open(folder / "blocks");
  const PackageMap& map = package.maps()[0];
  EXPECT_EQ(map.neutral_format, GetParam());
  EXPECT_EQ(map.neutral_file, "albedo/neutral.ktx2");
  EXPECT_EQ(map.differences[3].format, GetParam());
  const auto texture = static_cast<std::uint64_t>(blocks::blockBytes(GetParam(), map.width, map.height));
  const std::uint64_t weights = Package::open(folder / "images").bytesInMemory() - 5 * map.frameBytes();
  EXPECT_EQ(package.bytesInMemory(), 5 * texture + weights);
  // Spots on a smooth ground: images of this capture are exact but for rounding, and blocks nearly so.
  const double most = GetParam() == BlockFormat::kBc1 ? 1.6 : GetParam() == BlockFormat::kAstc6x6 ? 0.9 : 0.5;
  EXPECT_LT(rmse(capture, folder / "blocks"), most);
}

TEST_P(BlockPackage, IsTheSameBytesTwice) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 6, .maps = {"albedo", "normal"}});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  compressCapture(capture, folder / "a", smallOptions(GetParam()), testDevice(), progress);
  compressCapture(capture, folder / "b", smallOptions(GetParam()), testDevice(), progress);
  EXPECT_EQ(test::filesOf(folder / "a"), test::filesOf(folder / "b"));
}

INSTANTIATE_TEST_SUITE_P(Formats, BlockPackage,
                         testing::Values(BlockFormat::kBc7, BlockFormat::kBc1, BlockFormat::kAstc4x4,
                                         BlockFormat::kAstc6x6),
                         [](const auto& format) {
                           std::string name(blockFormatName(format.param));
                           std::erase(name, '-');
                           return name;
                         });

TEST(BlockPackages, AreBetterThanImagesThatAreCodedAfterwards) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 9});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  compressCapture(capture, folder / "blocks", smallOptions(BlockFormat::kBc1), testDevice(), progress);
  compressCapture(capture, folder / "images", smallOptions(), testDevice(), progress);
  test::codeAfterwards(folder / "images", BlockFormat::kBc1);
  EXPECT_LT(rmse(capture, folder / "blocks"), 0.85 * rmse(capture, folder / "images"));
}

TEST(BlockPackages, WeightsThatSuitTheBlocksAreBetterThanThoseThatDoNot) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 9});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  CompressOptions options = smallOptions(BlockFormat::kBc1);
  compressCapture(capture, folder / "refined", options, testDevice(), progress);
  options.method = Method::kPaper;
  compressCapture(capture, folder / "paper", options, testDevice(), progress);
  EXPECT_LT(rmse(capture, folder / "refined"), rmse(capture, folder / "paper"));
}

TEST(BlockPackages, TakeOtherBlocksForDifferences) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 6});
  Progress progress;
  CompressOptions options = smallOptions(BlockFormat::kAstc5x5);
  options.difference_format = BlockFormat::kAstc8x8;
  compressCapture(openCapture(folder / "c"), folder / "p", options, testDevice(), progress);
  const Package package = Package::open(folder / "p");
  EXPECT_EQ(package.maps()[0].neutral_format, BlockFormat::kAstc5x5);
  EXPECT_EQ(package.maps()[0].differences[0].format, BlockFormat::kAstc8x8);
}

TEST(BlockPackages, HaveMipLevelsOfWhatTheyDecodeTo) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 6});
  Progress progress;
  compressCapture(openCapture(folder / "c"), folder / "p", smallOptions(BlockFormat::kBc7), testDevice(), progress);
  const fs::path file = folder / "p/albedo/difference_0.ktx2";
  const blocks::TextureFileReader reader(file, InputFile(file, "a texture"));
  const blocks::BlockTexture& texture = reader.texture();
  EXPECT_EQ(texture.levels, blocks::mostLevels(texture.width, texture.height));
  EXPECT_FALSE(texture.srgb);  // samplers must not undo a curve before textures are added
  const auto decoder = blocks::makeBlockDecoder(BlockFormat::kBc7, 3);
  const auto mean = [&](int level) {
    const int width = blocks::levelSide(texture.width, level);
    const int height = blocks::levelSide(texture.height, level);
    std::vector<float> texels(static_cast<std::size_t>(width * height * 3));
    decoder->decode(width, height, reader.readLevel(level), std::span(texels));
    double sum = 0.0;
    for (const float texel : texels) sum += static_cast<double>(texel);
    return sum / static_cast<double>(texels.size());
  };
  // Coverage weighs the means, so they are near but not the same.
  EXPECT_NEAR(mean(1), mean(0), 6.0);
}

TEST(BlockPackages, KeepMapsOfMoreBitsAsImages) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 6});
  test::writeSmallCapture(folder / "c",
                          {.expressions = 6, .type = image::SampleType::kUint16, .maps = {"displacement"}});
  Notes progress;
  compressCapture(openCapture(folder / "c"), folder / "p", smallOptions(BlockFormat::kBc7), testDevice(), progress);
  const Package package = Package::open(folder / "p");
  const PackageMap& wide = package.maps()[static_cast<std::size_t>(package.mapIndex("displacement"))];
  EXPECT_EQ(wide.neutral_format, std::nullopt);
  EXPECT_EQ(wide.neutral_file, "displacement/neutral.png");
  EXPECT_THAT(progress.all, testing::Contains(testing::HasSubstr("displacement")));
}

TEST(BlockPackages, OfTooFewChannelsAreRefusedBeforeTheWork) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 6});
  Notes progress;
  try {
    compressCapture(openCapture(folder / "c"), folder / "p", smallOptions(BlockFormat::kBc5), testDevice(), progress);
    FAIL() << "compressed";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("albedo"));
    EXPECT_THAT(error.what(), testing::HasSubstr("bc5"));
  }
  EXPECT_FALSE(fs::exists(folder / "p"));
}

TEST(BlockPackages, DoNotOpenWithAnotherTexture) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 6});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  compressCapture(capture, folder / "p", smallOptions(BlockFormat::kBc7), testDevice(), progress);
  compressCapture(capture, folder / "q", smallOptions(BlockFormat::kBc1), testDevice(), progress);
  fs::copy_file(folder / "q/albedo/neutral.ktx2", folder / "p/albedo/neutral.ktx2",
                fs::copy_options::overwrite_existing);
  try {
    Package::open(folder / "p");
    FAIL() << "opened";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("neutral.ktx2"));
    EXPECT_THAT(error.what(), testing::HasSubstr("bc1"));
  }
  fs::resize_file(folder / "q/albedo/neutral.ktx2", fs::file_size(folder / "q/albedo/neutral.ktx2") - 1);
  EXPECT_THROW(Package::open(folder / "q"), InputError);
}

TEST(BlockPackages, SayWhatIsWrongInTheirDescription) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 6});
  Progress progress;
  compressCapture(openCapture(folder / "c"), folder / "p", smallOptions(BlockFormat::kBc7), testDevice(), progress);
  const fs::path file = folder / "p/package.json";
  const nlohmann::json good = nlohmann::json::parse(test::contentsOf(file));
  EXPECT_EQ(good["version"], 3);
  const auto refusal = [&](const std::string& field, const nlohmann::json& value) {
    nlohmann::json bad = good;
    bad[nlohmann::json::json_pointer(field)] = value;
    std::ofstream(file) << bad;
    try {
      Package::open(folder / "p");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("opened");
  };
  EXPECT_EQ(refusal("/name", "another"), "opened");
  EXPECT_THAT(refusal("/version", 2), testing::HasSubstr("version: expected 3, for textures in blocks"));
  EXPECT_THAT(refusal("/maps/0/neutral/format", "bc9"),
              testing::HasSubstr("maps[0].neutral.format: expected one of bc1"));
  EXPECT_THAT(refusal("/maps/0/neutral/format", "bc5"), testing::HasSubstr("a format of 3 channels"));
  EXPECT_THAT(refusal("/maps/0/neutral/file", "albedo/neutral.png"), testing::HasSubstr("the name of a .ktx2 file"));
  EXPECT_THAT(refusal("/maps/0/sample_type", "16-bit"), testing::HasSubstr("blocks hold maps of 8 bits"));
  EXPECT_THAT(refusal("/maps/0/difference_bits", 16), testing::HasSubstr("none beside difference_bits of 16"));
  EXPECT_THAT(refusal("/maps/0/differences/1/format", "bc1"), testing::HasSubstr("difference_1.ktx2"));
}

TEST(EveryTexture, IsMeasuredInBlocksOfItsOwn) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  compressCapture(capture, folder / "p", smallOptions(), testDevice(), progress);
  const Package package = Package::open(folder / "p");
  EvaluateOptions options;
  options.methods = {};
  options.every_texture = {BlockFormat::kBc1, BlockFormat::kAstc6x6};
  const Evaluation evaluation = evaluatePackage(capture, package, options, testDevice(), progress);
  EXPECT_EQ(evaluation.bytes.at("every-bc1"), 4u * 80 * 80 / 2);
  EXPECT_EQ(evaluation.bytes.at("every-astc-6x6"), 4u * 14 * 14 * 16);

  // The one texture that is covered most, coded here: what is reported is of its covered texels alone.
  image::Image texture = image::readImage(capture.maps[0].expressions[1]);
  blocks::EncoderOptions coding;
  coding.format = BlockFormat::kBc1;
  const std::span samples(reinterpret_cast<const std::uint8_t*>(texture.samples.data()), texture.samples.size());
  std::vector<std::byte> coded(blocks::blockBytes(coding.format, 80, 80));
  std::vector<float> decoded(samples.size());
  blocks::makeBlockEncoder(testDevice().context(), coding)->encode({80, 80, 3, samples, {}}, coded, decoded);
  double sum = 0.0, count = 0.0;
  for (int y = 8; y < 72; ++y) {  // UVs fill a tenth to nine tenths
    for (int x = 8; x < 72; ++x) {
      for (std::size_t s = static_cast<std::size_t>(3 * (80 * y + x)), end = s + 3; s < end; ++s, ++count) {
        const double error = static_cast<double>(decoded[s]) - samples[s];
        sum += error * error;
      }
    }
  }
  EXPECT_NEAR(evaluation.maps[0].rmse.at("every-bc1").per_expression[1], std::sqrt(sum / count), 1e-3);
}

}  // namespace
}  // namespace facezip
