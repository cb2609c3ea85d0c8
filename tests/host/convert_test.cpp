// Packages in other blocks: fitted to their own frames, whole, the same twice.
#include "facezip/convert.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "coded_afterwards.hpp"
#include "facezip/compress.hpp"
#include "facezip/evaluate.hpp"
#include "facezip/rig.hpp"
#include "file_contents.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "notes.hpp"
#include "rig_capture.hpp"
#include "small_capture.hpp"
#include "template_parts.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using test::testDevice;

CompressOptions smallOptions(std::optional<BlockFormat> format = {}) {
  CompressOptions options;
  options.unit = "m";
  options.mask_radius = {5.0, geometry::LengthUnit::kCentimetre};
  options.restarts = 10;
  options.cluster_restarts = 8;
  options.texture_format = format;
  return options;
}

ConvertReport convert(const fs::path& from, const fs::path& to, std::optional<BlockFormat> format,
                      std::optional<BlockFormat> differences = {}) {
  Progress progress;
  ConvertOptions options;
  options.texture_format = format;
  options.difference_format = differences;
  return convertPackage(Package::open(from), to, options, testDevice(), progress);
}

double rmse(const Capture& capture, const fs::path& package) {
  Progress progress;
  return evaluatePackage(capture, Package::open(package), {}, testDevice(), progress).maps[0].rmse.at("package").pooled;
}

/// A capture in which textures err, and its package of images.
class Convert : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryDirectory;
    test::writeSmallCapture(*folder_ / "c", {.expressions = 9});
    compress("images", {});
  }
  static void TearDownTestSuite() { delete folder_; }
  static void compress(const std::string& name, std::optional<BlockFormat> format) {
    Progress progress;
    compressCapture(capture(), at(name), smallOptions(format), testDevice(), progress);
  }
  static Capture capture() { return openCapture(at("c")); }
  static fs::path at(const std::string& name) { return *folder_ / name; }

  static const test::TemporaryDirectory* folder_;
};
const test::TemporaryDirectory* Convert::folder_ = nullptr;

TEST_F(Convert, IsAsNearToTheCaptureAsBlocksThatWereMadeOfIt) {
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc7, BlockFormat::kAstc6x6}) {
    compress("made", format);
    convert(at("images"), at("converted"), format);
    EXPECT_LT(rmse(capture(), at("converted")), 1.1 * rmse(capture(), at("made")) + 0.05) << blockFormatName(format);
  }
}

TEST_F(Convert, ClosesTheLoop) {
  convert(at("images"), at("converted"), BlockFormat::kBc1);
  fs::remove_all(at("afterwards"));
  fs::copy(at("images"), at("afterwards"), fs::copy_options::recursive);
  test::codeAfterwards(at("afterwards"), BlockFormat::kBc1);
  EXPECT_LT(rmse(capture(), at("converted")), 0.85 * rmse(capture(), at("afterwards")));
}

TEST_F(Convert, ReportsBytesAndHowFarItsFramesAreFromThePackages) {
  const ConvertReport report = convert(at("images"), at("converted"), BlockFormat::kBc7, BlockFormat::kBc1);
  const Package before = Package::open(at("images"));
  const Package after = Package::open(at("converted"));
  EXPECT_EQ(report.memory_before, before.bytesInMemory());
  EXPECT_EQ(report.memory_after, after.bytesInMemory());
  EXPECT_EQ(report.disk_after, after.bytesOnDisk());
  ASSERT_EQ(report.maps.size(), 1u);
  EXPECT_EQ(report.maps[0].bytes_before, 5u * 80 * 80 * 3);
  EXPECT_EQ(report.maps[0].bytes_after, 80u * 80 + 4u * 80 * 80 / 2);
  EXPECT_EQ(report.maps[0].texture_format, BlockFormat::kBc7);
  EXPECT_EQ(report.maps[0].difference_format, BlockFormat::kBc1);
  // The package of images is all but exact: what is off to it is off to the capture.
  EXPECT_NEAR(report.maps[0].rmse, rmse(capture(), at("converted")), 0.25 * report.maps[0].rmse);
  const nlohmann::json method = nlohmann::json::parse(after.methodJson());
  EXPECT_EQ(method["texture_format"], "bc7");
  EXPECT_EQ(method["difference_format"], "bc1");
  EXPECT_EQ(test::contentsOf(at("converted/mesh.glb")), test::contentsOf(at("images/mesh.glb")));
}

TEST_F(Convert, BlocksBecomeOthersAndImages) {
  convert(at("images"), at("bc7"), BlockFormat::kBc7);
  const ConvertReport astc = convert(at("bc7"), at("astc"), BlockFormat::kAstc4x4);
  EXPECT_LT(astc.maps[0].rmse, 0.6);
  const ConvertReport images = convert(at("astc"), at("back"), std::nullopt);
  EXPECT_LT(images.maps[0].rmse, 0.6);  // codes are rounded, by half at the most
  EXPECT_EQ(images.maps[0].texture_format, std::nullopt);
  const Package package = Package::open(at("back"));
  EXPECT_EQ(package.maps()[0].neutral_file, "albedo/neutral.png");
  EXPECT_EQ(nlohmann::json::parse(test::contentsOf(at("back/package.json")))["version"], 2);
  EXPECT_FALSE(nlohmann::json::parse(package.methodJson()).contains("texture_format"));
  EXPECT_FALSE(fs::exists(at("back/albedo/neutral.ktx2")));
}

TEST_F(Convert, IsTheSameBytesTwice) {
  convert(at("images"), at("a"), BlockFormat::kAstc6x6);
  convert(at("images"), at("b"), BlockFormat::kAstc6x6);
  EXPECT_EQ(test::filesOf(at("a")), test::filesOf(at("b")));
}

TEST_F(Convert, WithoutAMeshEveryTexelCounts) {
  Progress progress;
  CompressOptions options = smallOptions();
  options.mesh = false;
  compressCapture(capture(), at("bare"), options, testDevice(), progress);
  EXPECT_LT(convert(at("bare"), at("bare-bc7"), BlockFormat::kBc7).maps[0].rmse, 0.5);
}

TEST_F(Convert, WeightsOfManyTexturesAndSetsAreKeptInOrder) {
  test::writeSmallCapture(at("two"), {.expressions = 9, .maps = {"albedo", "gloss"}});
  Progress progress;
  CompressOptions options = smallOptions();
  options.differences = 5;  // two atlases
  options.weight_sets = WeightSets::kPerMap;
  compressCapture(openCapture(at("two")), at("sets"), options, testDevice(), progress);
  const ConvertReport report = convert(at("sets"), at("sets-bc7"), BlockFormat::kBc7);
  for (const ConvertReport::Map& map : report.maps) EXPECT_LT(map.rmse, 0.5) << map.name;
}

TEST_F(Convert, MapsOfMoreBitsAndTheirWeightsAreCopied) {
  test::writeSmallCapture(at("deep"), {.expressions = 6});
  test::writeSmallCapture(at("deep"), {.expressions = 6, .type = image::SampleType::kUint16, .maps = {"height"}});
  test::Notes progress;
  compressCapture(openCapture(at("deep")), at("shared"), smallOptions(), testDevice(), progress);
  ConvertOptions options;
  options.texture_format = BlockFormat::kBc7;
  const ConvertReport report =
      convertPackage(Package::open(at("shared")), at("shared-bc7"), options, testDevice(), progress);
  for (const char* file : {"weights.png", "height/neutral.png", "height/difference_3.png"}) {
    EXPECT_EQ(image::readImage(at("shared-bc7") / file).samples, image::readImage(at("shared") / file).samples) << file;
  }
  EXPECT_GT(report.maps[0].rmse, 0.0);
  EXPECT_LT(report.maps[0].rmse, 0.7);
  EXPECT_EQ(report.maps[1].rmse, 0.0);
  EXPECT_THAT(progress.all, testing::Contains(testing::HasSubstr("height has 16-bit samples")));
}

TEST_F(Convert, ARigStaysARigAndKeepsItsWeights) {
  test::writeRigCapture(at("r"));
  Progress progress;
  RigOptions options;
  options.compress = smallOptions();
  options.fit.iterations = 2;
  rigCapture(openCapture(at("r/capture")), at("r/template"), at("rig"), options, testDevice(), progress);
  convert(at("rig"), at("rig-astc"), BlockFormat::kAstc5x5);
  const Package package = Package::open(at("rig-astc"));
  EXPECT_EQ(openRig(package).shapes, openRig(Package::open(at("rig"))).shapes);
  EXPECT_EQ(image::readImage(at("rig-astc/weights.png")).samples, image::readImage(at("rig/weights.png")).samples);
  EXPECT_EQ(test::contentsOf(at("rig-astc/shapes/bumpA.obj")), test::contentsOf(at("rig/shapes/bumpA.obj")));
  EXPECT_EQ(test::contentsOf(at("rig-astc/rig.bin")), test::contentsOf(at("rig/rig.bin")));
  const nlohmann::json scene = nlohmann::json::parse(test::contentsOf(at("rig-astc/rig.gltf")));
  EXPECT_FALSE(scene.contains("images"));  // the neutral that it showed is no image any more
  EXPECT_TRUE(nlohmann::json::parse(test::contentsOf(at("rig/rig.gltf"))).contains("images"));
}

TEST_F(Convert, PartsStayAsTheyAre) {
  test::writeRigCapture(at("h"));
  test::appendParts(at("h/template"));
  Progress progress;
  RigOptions options;
  options.compress = smallOptions();
  options.fit.iterations = 1;
  rigCapture(openCapture(at("h/capture")), at("h/template"), at("head"), options, testDevice(), progress);
  const std::vector<PackageMaterial> materials = Package::open(at("head")).description().parts->materials;
  for (const auto& [name, format] : {std::pair("head-bc7", std::optional(BlockFormat::kBc7)),
                                     std::pair("head-back", std::optional<BlockFormat>())}) {
    convert(at(format ? "head" : "head-bc7"), at(name), format);
    const Package package = Package::open(at(name));
    ASSERT_TRUE(package.description().parts);
    EXPECT_EQ(test::contentsOf(at(name) / "parts.glb"), test::contentsOf(at("head/parts.glb")));
    int textures = 0;
    for (const PackageMaterial& material : package.description().parts->materials) {
      if (material.texture.empty()) continue;
      ++textures;
      EXPECT_EQ(test::contentsOf(at(name) / material.texture), test::contentsOf(at("head") / material.texture));
    }
    EXPECT_GT(textures, 0);
    // The rig's scene still shows them, and of the neutral, which is no image any more, nothing.
    const nlohmann::json scene = nlohmann::json::parse(test::contentsOf(at(name) / "rig.gltf"));
    std::vector<std::string> shown;
    for (const nlohmann::json& material : scene["materials"]) {
      const nlohmann::json& surface = material["pbrMetallicRoughness"];
      if (!surface.contains("baseColorTexture")) continue;
      const std::size_t texture = surface["baseColorTexture"]["index"];
      const std::size_t image = scene["textures"][texture]["source"];
      shown.push_back(scene["images"][image]["uri"]);
      EXPECT_TRUE(fs::exists(at(name) / shown.back())) << shown.back();
    }
    EXPECT_EQ(static_cast<int>(shown.size()), textures);
    for (const nlohmann::json& image : scene["images"]) EXPECT_TRUE(fs::exists(at(name) / image["uri"]));
  }
}

TEST_F(Convert, BadInputIsRefusedBeforeTheWork) {
  const auto refusal = [&](const fs::path& from, std::optional<BlockFormat> format) {
    try {
      convert(from, at("refused"), format);
    } catch (const InputError& error) {
      EXPECT_FALSE(fs::exists(at("refused")));
      return std::string(error.what());
    }
    return std::string("converted");
  };
  EXPECT_THAT(refusal(at("images"), BlockFormat::kBc5), testing::HasSubstr("map albedo: expected"));
  EXPECT_THAT(refusal(at("images"), std::nullopt), testing::HasSubstr("images alone"));
  test::writeSmallCapture(at("floats"), {.expressions = 5, .type = image::SampleType::kFloat32, .extension = "exr"});
  Progress progress;
  compressCapture(openCapture(at("floats")), at("float"), smallOptions(), testDevice(), progress);
  EXPECT_THAT(refusal(at("float"), BlockFormat::kBc7), testing::HasSubstr("one of 8 bits"));
  // A stranger's: coarser weights than facezip writes.
  fs::copy(at("images"), at("coarse"), fs::copy_options::recursive);
  nlohmann::json document = nlohmann::json::parse(test::contentsOf(at("coarse/package.json")));
  document["maps"][0]["weight_scale"] = 80;
  nlohmann::json& weights = document["weights"][0];
  weights["tile_width"] = weights["tile_height"] = 1;
  const int columns = weights["columns"], rows = weights["rows"];
  image::Image atlas{{3 * columns, 3 * rows, 4, image::SampleType::kUint8}, {}};
  atlas.samples.resize(static_cast<std::size_t>(atlas.shape.height) * atlas.shape.rowBytes());
  image::writeImage(at("coarse/weights.png"), atlas);
  io::writeTextFile(at("coarse/package.json"), document.dump());
  EXPECT_THAT(refusal(at("coarse"), BlockFormat::kBc7), testing::HasSubstr("weight_scale: expected at most 64"));
}

TEST_F(Convert, CancelledLeavesNothing) {
  struct : Progress {
    void stage(std::string_view name, std::size_t) override {
      if (name.starts_with("fitting")) cancel();
    }
  } progress;
  ConvertOptions options;
  options.texture_format = BlockFormat::kBc7;
  const test::TemporaryDirectory out;
  EXPECT_THROW(convertPackage(Package::open(at("images")), out / "p", options, testDevice(), progress), Cancelled);
  EXPECT_TRUE(fs::is_empty(out.path()));
}

}  // namespace
}  // namespace facezip
