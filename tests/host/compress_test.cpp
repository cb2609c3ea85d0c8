#include "facezip/compress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "face/face.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/reconstruct.hpp"
#include "file_contents.hpp"
#include "io/staged_directory.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using test::testDevice;
namespace fs = std::filesystem;

/// Options for captures of 80 texels on a patch of 20 cm.
CompressOptions smallOptions() {
  CompressOptions options;
  options.unit = "m";
  options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
  options.restarts = 30;
  options.cluster_restarts = 16;
  return options;
}

/// Compresses the capture in `folder`/c and evaluates it without baselines that compress again.
Evaluation roundTrip(const fs::path& folder, const CompressOptions& options = smallOptions()) {
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  compressCapture(capture, folder / "p", options, testDevice(), progress);
  return evaluatePackage(capture, Package::open(folder / "p"), {.methods = {Method::kPaper}}, testDevice(), progress);
}

TEST(Compress, ReproducesUpToFourExpressions) {
  for (const int expressions : {1, 2, 3, 4}) {
    const test::TemporaryDirectory folder;
    test::writeSmallCapture(folder / "c", {.expressions = expressions});
    const Evaluation evaluation = roundTrip(folder.path());
    EXPECT_GT(evaluation.maps[0].rms_difference, 2.0);
    // Rounding differences to 8 bits and the sum to 8 bits again: about 1/sqrt(6) of a code at the most.
    EXPECT_LT(evaluation.maps[0].rmse.at("package").pooled, 0.5) << expressions << " expressions";
  }
}

TEST(Compress, ReproducesExpressionsThatRepeatFour) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 11, .distinct = 4});
  EXPECT_LT(roundTrip(folder.path()).maps[0].rmse.at("package").pooled, 0.5);
}

TEST(Compress, NotesFilesOfOneMapThatSayOtherThingsOfTheirColours) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3});
  const fs::path file = folder / "c/albedo/e01.png";
  image::writeImage(file, image::readImage(file), "linear");
  struct : Progress {
    void note(std::string_view message) override { text += message; }
    std::string text;
  } progress;
  compressCapture(openCapture(folder / "c"), folder / "p", smallOptions(), testDevice(), progress);
  EXPECT_THAT(progress.text, testing::HasSubstr("e01.png says linear"));
}

TEST(Compress, IsBetterThanStoringNothingAndThanNoPermutation) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 12});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  compressCapture(capture, folder / "p", smallOptions(), testDevice(), progress);
  const Evaluation evaluation = evaluatePackage(capture, Package::open(folder / "p"), {}, testDevice(), progress);
  const Evaluation::Map& map = evaluation.maps[0];
  EXPECT_LT(map.rmse.at("package").pooled, map.rmse.at("no-permutation").pooled);
  EXPECT_LT(map.rmse.at("package").pooled, map.rms_difference);
  EXPECT_LT(map.rmse.at("pca8").pooled, map.rmse.at("pca4").pooled);
  EXPECT_LT(map.rmse.at("pca4").pooled, map.rms_difference);
}

TEST(Compress, GivesTheSameBytesTwice) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 7, .maps = {"albedo", "normal"}});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  compressCapture(capture, folder / "a", smallOptions(), testDevice(), progress);
  compressCapture(capture, folder / "b", smallOptions(), testDevice(), progress);
  EXPECT_EQ(test::filesOf(folder / "a"), test::filesOf(folder / "b"));
  CompressOptions other = smallOptions();
  other.seed = 2;
  compressCapture(capture, folder / "b", other, testDevice(), progress);
  EXPECT_NE(test::filesOf(folder / "a"), test::filesOf(folder / "b"));
}

struct TypeCase {
  const char* name;
  image::SampleType type;
  const char* extension;
  int channels;
};

class CompressTypes : public testing::TestWithParam<TypeCase> {};

TEST_P(CompressTypes, KeepsTheNeutralExactlyAndTheExpressionsClosely) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(
      folder / "c",
      {.expressions = 4, .channels = GetParam().channels, .type = GetParam().type, .extension = GetParam().extension});
  EXPECT_LT(roundTrip(folder.path()).maps[0].rmse.at("package").pooled, 0.5);
  const Package package = Package::open(folder / "p");
  EXPECT_EQ(package.maps()[0].sample_type, GetParam().type);
  const auto stored = image::readImage(folder / "p" / package.maps()[0].neutral_file);
  EXPECT_EQ(stored.samples,
            image::readImage(folder / "c/albedo" / (std::string("neutral.") + GetParam().extension)).samples);
}

INSTANTIATE_TEST_SUITE_P(Types, CompressTypes,
                         testing::Values(TypeCase{"gray8", image::SampleType::kUint8, "png", 1},
                                         TypeCase{"rgba8", image::SampleType::kUint8, "png", 4},
                                         TypeCase{"rgb16", image::SampleType::kUint16, "png", 3},
                                         TypeCase{"gray16tif", image::SampleType::kUint16, "tif", 1},
                                         TypeCase{"exr", image::SampleType::kFloat32, "exr", 3}),
                         [](const auto& type_case) { return type_case.param.name; });

TEST(Compress, MapsOfOtherSizesShareTheWeightGrid) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 4, .width = 96, .height = 64, .maps = {"albedo"}});
  test::writeSmallCapture(folder / "small",
                          {.expressions = 4, .width = 48, .height = 32, .channels = 1, .maps = {"roughness"}});
  fs::rename(folder / "small/roughness", folder / "c/roughness");
  const Evaluation evaluation = roundTrip(folder.path());
  const Package package = Package::open(folder / "p");
  EXPECT_EQ(package.maps()[0].weight_scale, 8);
  EXPECT_EQ(package.maps()[1].weight_scale, 4);
  for (const Evaluation::Map& map : evaluation.maps) EXPECT_LT(map.rmse.at("package").pooled, 0.6) << map.name;
}

TEST(Compress, RefusesMapsThatCannotShareAWeightGrid) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 96, .height = 64});
  test::writeSmallCapture(folder / "small", {.expressions = 2, .width = 50, .height = 32, .maps = {"roughness"}});
  fs::rename(folder / "small/roughness", folder / "c/roughness");
  EXPECT_THROW(roundTrip(folder.path()), InputError);
  EXPECT_FALSE(fs::exists(folder / "p"));
}

TEST(Compress, OddSizesAndWeightScales) {
  for (const int scale : {1, 4, 8, 16}) {
    const test::TemporaryDirectory folder;
    test::writeSmallCapture(folder / "c", {.expressions = 3, .width = 93, .height = 61});
    CompressOptions options = smallOptions();
    options.weight_scale = scale;
    EXPECT_LT(roundTrip(folder.path(), options).maps[0].rmse.at("package").pooled, 0.5) << "scale " << scale;
  }
}

TEST(Compress, SmallMemoryGivesThinBandsAndTheSameQuality) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 4, .width = 64, .height = 400});
  Progress progress;
  const Capture capture = openCapture(folder / "c");
  CompressOptions options = smallOptions();
  const CompressReport wide = compressCapture(capture, folder / "p", options, testDevice(), progress);
  options.memory_bytes = 258u << 20;
  const CompressReport thin = compressCapture(capture, folder / "q", options, testDevice(), progress);
  EXPECT_LT(thin.band_rows, wide.band_rows);
  const Evaluation evaluation =
      evaluatePackage(capture, Package::open(folder / "q"), {.methods = {Method::kPaper}}, testDevice(), progress);
  EXPECT_LT(evaluation.maps[0].rmse.at("package").pooled, 0.5);
}

TEST(Compress, MasksByCount) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 5});
  CompressOptions options = smallOptions();
  options.masks = 9;
  Progress progress;
  EXPECT_EQ(compressCapture(openCapture(folder / "c"), folder / "p", options, testDevice(), progress).masks, 9);
}

TEST(Compress, RegionCanBePaintedOrListed) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 4});
  Progress progress;
  const Capture whole = openCapture(folder / "c");
  const auto covered = [&](const Capture& capture, const std::string& region) {
    CompressOptions options = smallOptions();
    options.region = region;
    return compressCapture(capture, folder / "p", options, testDevice(), progress).covered_texels;
  };
  const std::uint64_t all = covered(whole, "");
  image::writeImage(folder / "half.png", test::makeImage({80, 80, 1, image::SampleType::kUint8},
                                                         [](int x, int, int) { return x < 40 ? 255.0 : 0.0; }));
  EXPECT_NEAR(static_cast<double>(covered(whole, (folder / "half.png").string())), 0.5 * static_cast<double>(all),
              0.05 * static_cast<double>(all));
  std::string half;
  for (int t = 0; t < 400; ++t) half += std::to_string(t) + "\n";
  io::writeTextFile(folder / "c/face_region.txt", half);
  EXPECT_NEAR(static_cast<double>(covered(openCapture(folder / "c"), "")), 0.5 * static_cast<double>(all),
              0.05 * static_cast<double>(all));
  EXPECT_EQ(covered(openCapture(folder / "c"), "whole"), all);
}

TEST(Compress, CancelLeavesNothing) {
  class CancelInStage : public Progress {
   public:
    explicit CancelInStage(std::string stage) : stage_(std::move(stage)) {}
    void stage(std::string_view name, std::size_t) override {
      if (name.find(stage_) != std::string_view::npos) cancel();
    }

   private:
    std::string stage_;
  };
  for (const char* stage : {"masks", "Gram", "clustering", "permutation", "writing"}) {
    const test::TemporaryDirectory folder;
    test::writeSmallCapture(folder / "c", {.expressions = 3});
    CancelInStage progress(stage);
    EXPECT_THROW(compressCapture(openCapture(folder / "c"), folder / "p", smallOptions(), testDevice(), progress),
                 Cancelled)
        << stage;
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1) << stage;
  }
}

TEST(Evaluate, RefusesAPackageOfAnotherCapture) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3});
  test::writeSmallCapture(folder / "d", {.expressions = 2});
  Progress progress;
  compressCapture(openCapture(folder / "c"), folder / "p", smallOptions(), testDevice(), progress);
  EXPECT_THROW(evaluatePackage(openCapture(folder / "d"), Package::open(folder / "p"), {}, testDevice(), progress),
               InputError);
}

TEST(Evaluate, MeetsThePublishedFiguresOfTheRealCapture) {
  const char* directory = std::getenv("FACEZIP_TEST_CAPTURE");
  if (directory == nullptr) GTEST_SKIP() << "set FACEZIP_TEST_CAPTURE to a copy of the ICT expression set";
  const test::TemporaryDirectory folder;
  Progress progress;
  const Capture capture = openCapture(directory, {"albedo"});
  compressCapture(capture, folder / "p", {}, testDevice(), progress);
  const Evaluation evaluation = evaluatePackage(capture, Package::open(folder / "p"), {}, testDevice(), progress);
  const Evaluation::Map& map = evaluation.maps[0];
  EXPECT_NEAR(map.rms_difference, 3.4055, 0.005 * 3.4055);
  EXPECT_NEAR(map.rmse.at("pca4").pooled, 1.978, 0.005 * 1.978);
  EXPECT_NEAR(map.rmse.at("pca8").pooled, 1.520, 0.005 * 1.520);
  EXPECT_LT(map.rmse.at("package").pooled, map.rmse.at("pca4").pooled);
  EXPECT_GT(map.rmse.at("no-permutation").pooled, map.rmse.at("pca4").pooled);
}

TEST(ReadFace, RegionsMayBePaintedInAnyColour) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "capture", {.expressions = 2});
  const Capture capture = openCapture(folder / "capture");
  image::writeImage(folder / "green.png",
                    test::makeImage({16, 16, 3, image::SampleType::kUint8},
                                    [](int x, int, int c) { return c == 1 && x < 8 ? 255.0 : 0.0; }));
  image::writeImage(folder / "white.png", test::makeImage({16, 16, 1, image::SampleType::kUint8},
                                                          [](int x, int, int) { return x < 8 ? 255.0 : 0.0; }));
  const std::vector<int> region = compress::readFace(capture, folder / "green.png").region;
  EXPECT_FALSE(region.empty());
  EXPECT_EQ(region, compress::readFace(capture, folder / "white.png").region);
}

}  // namespace
}  // namespace facezip
