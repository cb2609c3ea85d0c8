#include "facezip/gain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "facezip/blend.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "package/package_json.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using testing::Each;
using testing::HasSubstr;

/// The sample package with two masks: the left and the right half of the map, regions "left" and "right". Half the
/// cells of the weights, so that masks are interpolated.
class Gains : public testing::Test {
 protected:
  Gains() {
    test::SamplePackage sample = test::makeSample();
    test::writeSample(sample, folder_ / "package");
    PackageDescription description = Package::open(folder_ / "package").description();
    description.masks = PackageMasks{"masks.png", 2, 2, 1, kColumns, 3, {{0.2, 0.5}, {0.8, 0.5}}};
    description.regions = {{"left", {0}}, {"right", {1}}};
    image::Image picture{{2 * kColumns, 3, 1, SampleType::kUint8}, {}};
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < kColumns; ++x) picture.samples.push_back(std::byte(x < 2 ? 255 : 0));
      for (int x = 0; x < kColumns; ++x) picture.samples.push_back(std::byte(x < 2 ? 0 : 255));
    }
    image::writeImage(folder_ / "package/masks.png", picture);
    std::ofstream(folder_ / "package/package.json") << package::packageJson(description);
  }

  Package open() const { return Package::open(folder_ / "package"); }
  json preset() const {
    return {{"format", "facezip-gains"},
            {"version", 1},
            {"package", "sample"},
            {"expressions", {{"expression_1", 2.0}}},
            {"regions", {{"left", 0.5}}}};
  }
  fs::path write(const json& preset) const {
    std::ofstream(folder_ / "gains.json") << preset.dump();
    return folder_ / "gains.json";
  }
  std::string messageOf(const json& preset) const {
    try {
      readGain(write(preset), open());
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "expected an InputError";
    return "";
  }
  std::vector<std::byte> frame(const std::vector<float>& beta, const Gain* gain) const {
    const Package package = open();
    Blender blender(package, test::testDevice());
    if (gain) blender.setGain(*gain);
    blender.setWeights(beta);
    std::vector<std::byte> out(package.maps()[0].frameBytes());
    blender.blend(0, out);
    return out;
  }

  static constexpr int kColumns = 5;
  test::TemporaryDirectory folder_;
};

TEST_F(Gains, UnitGainChangesNothing) {
  const Gain gain = unitGain(open());
  const std::vector<float> beta = {0.5f, 0.2f, 0.0f, 1.0f, 0.3f};
  EXPECT_EQ(frame(beta, &gain), frame(beta, nullptr));
}

TEST_F(Gains, OfExpressionsMultiplyTheirWeights) {
  json only = preset();
  only["regions"] = json::object();
  const Gain gain = readGain(write(only), open());
  EXPECT_THAT(gain.expressions, testing::ElementsAre(1, 2, 1, 1, 1));
  EXPECT_EQ(frame({0.0f, 0.25f, 0.0f, 0.0f, 0.5f}, &gain), frame({0.0f, 0.5f, 0.0f, 0.0f, 0.5f}, nullptr));
}

TEST_F(Gains, WhatAPresetDoesNotNameStaysAsItIs) {
  json expressions = preset();
  expressions.erase("regions");
  EXPECT_THAT(readGain(write(expressions), open()).expressions, testing::ElementsAre(1, 2, 1, 1, 1));
  json regions = preset();
  regions.erase("expressions");
  const Gain gain = readGain(write(regions), open());
  EXPECT_THAT(gain.expressions, Each(1.0f));
  EXPECT_THAT(gain.regions, testing::ElementsAre(0.5f, 1.0f));
}

TEST_F(Gains, OfARegionActInItAlone) {
  Gain gain = unitGain(open());
  gain.regions = {0.0f, 1.0f};
  applyRegions(open(), gain);
  ASSERT_EQ(gain.cells.size(), 1u);
  const std::vector<float> row(gain.cells[0].begin(), gain.cells[0].begin() + kColumns);
  EXPECT_THAT(row, testing::ElementsAre(0, 0, 1, 1, 1));
  const std::vector<float> beta = {1.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  const std::vector<std::byte> tuned = frame(beta, &gain);
  const std::vector<std::byte> neutral = frame(std::vector<float>(5, 0.0f), nullptr);
  const std::vector<std::byte> full = frame(beta, nullptr);
  const PackageMap map = open().maps()[0];
  const auto texel = [&](int x) { return static_cast<std::size_t>(x * map.channels); };
  EXPECT_EQ(tuned[texel(0)], neutral[texel(0)]);  // in the middle of a cell of gain 0
  EXPECT_EQ(tuned[texel(map.width - 1)], full[texel(map.width - 1)]);
  EXPECT_NE(full, neutral);
}

TEST_F(Gains, BadPresetsSayWhatIsWrong) {
  json other = preset();
  other["package"] = "another face";
  EXPECT_THAT(messageOf(other), HasSubstr("package: expected \"sample\", the package's name, got \"another face\""));
  json unknown = preset();
  unknown["expressions"]["smirk"] = 1.0;
  EXPECT_THAT(messageOf(unknown), HasSubstr("smirk"));
  json region = preset();
  region["regions"]["nose"] = 1.0;
  EXPECT_THAT(messageOf(region), HasSubstr("regions of the package (left, right)"));
  json negative = preset();
  negative["regions"]["left"] = -1.0;
  EXPECT_THAT(messageOf(negative), HasSubstr("regions.left"));
  json format = preset();
  format["format"] = "facezip-package";
  EXPECT_THAT(messageOf(format), HasSubstr("preset of gains"));
  json incomplete = preset();
  incomplete.erase("version");
  EXPECT_THAT(messageOf(incomplete),
              testing::AllOf(HasSubstr("version: got no such field"), HasSubstr("preset of gains")));
  EXPECT_THROW(readGain(folder_ / "nowhere.json", open()), InputError);
}

TEST_F(Gains, DamagedGuidesAreRefused) {
  const auto messageOfOpening = [this](const std::function<void(json&)>& change) {
    const fs::path file = folder_ / "package/package.json";
    const json before = json::parse(std::ifstream(file));
    json changed = before;
    change(changed);
    std::ofstream(file) << changed.dump();
    std::string message = "opened";
    try {
      open();
    } catch (const InputError& error) {
      message = error.what();
    }
    std::ofstream(file) << before.dump();
    return message;
  };
  EXPECT_THAT(messageOfOpening([](json& d) { d["regions"][1]["masks"][0] = 0; }), HasSubstr("no other region"));
  EXPECT_THAT(messageOfOpening([](json& d) { d["masks"]["samples"][1][0] = 1.01; }), HasSubstr("masks.samples[1][0]"));
  EXPECT_THAT(messageOfOpening([](json& d) { d["regions"][1]["masks"][0] = 2; }), HasSubstr("regions[1].masks[0]"));
  EXPECT_THAT(messageOfOpening([](json& d) { d["regions"][1]["name"] = "left"; }), HasSubstr("unique region names"));
  EXPECT_THAT(messageOfOpening([](json& d) { d["masks"]["count"] = 3; }), HasSubstr("tiles for 3 masks"));
  EXPECT_THAT(messageOfOpening([](json& d) { d["masks"]["tile_width"] = 4; }), HasSubstr("masks.png"));
  EXPECT_THAT(messageOfOpening([](json& d) { d["masks"]["file"] = "../masks.png"; }), HasSubstr("inside the package"));
  EXPECT_THAT(messageOfOpening([](json& d) { d.erase("masks"); }), HasSubstr("masks that regions are made of"));
  EXPECT_THAT(messageOfOpening([](json& d) { d["mesh"]["file"] = "mesh.glb"; }), HasSubstr("no such file"));
  std::ofstream(folder_ / "package/mesh.glb") << "glTF, but cut";
  EXPECT_THAT(messageOfOpening([](json& d) { d["mesh"]["file"] = "mesh.glb"; }), HasSubstr("binary glTF"));
  fs::remove(folder_ / "package/mesh.glb");
  fs::create_directory(folder_ / "package/mesh.glb");
  EXPECT_THAT(messageOfOpening([](json& d) { d["mesh"]["file"] = "mesh.glb"; }), HasSubstr("a folder"));
}

TEST_F(Gains, RegionsMayBeManyAndHaveNoMasks) {
  PackageDescription description = open().description();
  for (int r = 2; r < 100; ++r) description.regions.push_back({"empty " + std::to_string(r), {}});
  std::ofstream(folder_ / "package/package.json") << package::packageJson(description);
  EXPECT_EQ(open().description().regions.size(), 100u);
  json tuned = preset();
  const Gain left = readGain(write(tuned), open());
  tuned["regions"]["empty 99"] = 0.0;
  const Gain both = readGain(write(tuned), open());
  EXPECT_EQ(both.regions[99], 0.0f);
  EXPECT_EQ(both.cells, left.cells) << "no mask, no cell";
  const std::vector<float> beta = {0.5f, 0.2f, 0.0f, 1.0f, 0.3f};
  EXPECT_EQ(frame(beta, &both), frame(beta, &left));
}

}  // namespace
}  // namespace facezip
