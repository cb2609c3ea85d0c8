#include "facezip/synth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "facezip/error.hpp"
#include "file_contents.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

bool isEmpty(const fs::path& folder) { return fs::is_empty(folder); }

void synthesize(const fs::path& output, int resolution, int expressions, std::uint64_t seed,
                std::vector<std::string> maps = {"albedo", "normal"}) {
  Progress progress;
  synthesizeCapture(output, {resolution, expressions, std::move(maps), seed}, progress);
}

// ---- options and failures

struct BadOptions {
  const char* name;
  SynthOptions options;
};

class SynthOptionsTest : public testing::TestWithParam<BadOptions> {};

TEST_P(SynthOptionsTest, AreInputErrorsAndLeaveNothing) {
  const test::TemporaryDirectory folder;
  Progress progress;
  EXPECT_THROW(synthesizeCapture(folder / "a", GetParam().options, progress), InputError);
  EXPECT_TRUE(isEmpty(folder.path()));
}

INSTANTIATE_TEST_SUITE_P(Bad, SynthOptionsTest,
                         testing::Values(BadOptions{"ResolutionLow", {63, 1, {"albedo"}, 1}},
                                         BadOptions{"ResolutionHigh", {16385, 1, {"albedo"}, 1}},
                                         BadOptions{"NoExpressions", {64, 0, {"albedo"}, 1}},
                                         BadOptions{"TooManyExpressions", {64, 101, {"albedo"}, 1}},
                                         BadOptions{"NoMaps", {64, 1, {}, 1}},
                                         BadOptions{"UnknownMap", {64, 1, {"albedo", "glow"}, 1}},
                                         BadOptions{"RepeatedMap", {64, 1, {"albedo", "normal", "albedo"}, 1}}),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(Synth, UnwritableOutputIsAnOutputErrorAndLeavesNothing) {
  const test::TemporaryDirectory folder;
  io::writeTextFile(folder / "file", "precious");
  EXPECT_THROW(synthesize(folder / "file", 64, 1, 1), OutputError);
  EXPECT_THROW(synthesize(folder / "file/below", 64, 1, 1), OutputError);
  EXPECT_THAT(test::filesOf(folder.path()), testing::ElementsAre(testing::Pair("file", "precious")));
}

TEST(Synth, ReplacesAnEarlierCaptureWhole) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 64, 3, 1);
  synthesize(folder / "a", 64, 1, 1, {"albedo"});
  EXPECT_FALSE(fs::exists(folder / "a/normal"));
  EXPECT_FALSE(fs::exists(folder / "a/expressions/smile_open.obj"));
}

class CancelAfterFirstBand : public Progress {
 public:
  void stage(std::string_view name, std::size_t) override { painting_ = name == "textures"; }
  void advance(std::size_t) override {
    if (painting_) cancel();
  }

 private:
  bool painting_ = false;
};

TEST(Synth, CancellingLeavesNothing) {
  const test::TemporaryDirectory folder;
  CancelAfterFirstBand progress;
  EXPECT_THROW(synthesizeCapture(folder / "a", {128, 2, {"albedo"}, 1}, progress), Cancelled);
  EXPECT_TRUE(isEmpty(folder.path()));
}

// ---- what is written

TEST(Synth, SameOptionsGiveSameBytesOnAnyNumberOfThreads) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 100, 4, 7);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  synthesize(folder / "b", 100, 4, 7);
  EXPECT_EQ(test::filesOf(folder / "a"), test::filesOf(folder / "b"));
}

TEST(Synth, AnotherSeedIsAnotherFace) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 64, 1, 1);
  synthesize(folder / "b", 64, 1, 2);
  const auto a = test::filesOf(folder / "a");
  const auto b = test::filesOf(folder / "b");
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, bytes] : a) EXPECT_NE(bytes, b.at(name)) << name;
}

TEST(Synth, FewerExpressionsAreTheFirstOnes) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "few", 64, 2, 3);
  synthesize(folder / "more", 64, 5, 3);
  const auto more = test::filesOf(folder / "more");
  for (const auto& [name, bytes] : test::filesOf(folder / "few")) {
    if (name != "capture.json") {
      EXPECT_EQ(bytes, more.at(name)) << name;
    }
  }
}

TEST(Synth, ManifestNamesTheFiles) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 64, 3, 5);
  const auto manifest = nlohmann::json::parse(test::contentsOf(folder / "a/capture.json"));
  EXPECT_EQ(manifest["unit"], "m");
  EXPECT_EQ(manifest["seed"], 5);
  EXPECT_EQ(manifest["maps"]["albedo"]["colour_space"], "sRGB");
  EXPECT_EQ(manifest["maps"]["normal"]["colour_space"], "linear");
  ASSERT_EQ(manifest["expressions"].size(), 3u);
  for (const std::string name : manifest["expressions"]) {
    EXPECT_TRUE(fs::exists(folder / "a/albedo" / (name + ".png"))) << name;
    EXPECT_TRUE(fs::exists(folder / "a/normal" / (name + ".png"))) << name;
    EXPECT_TRUE(fs::exists(folder / "a/expressions" / (name + ".obj"))) << name;
  }
}

TEST(Synth, MapsHaveTheShapesPromised) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 70, 1, 1, {"displacement", "roughness", "albedo", "specular", "normal"});
  using image::SampleType;
  const auto shape = [&](const char* map) {
    return image::ImageReader(folder / "a" / map / "jaw_open_wide.png").shape();
  };
  EXPECT_EQ(shape("albedo"), (image::ImageShape{70, 70, 3, SampleType::kUint8}));
  EXPECT_EQ(shape("normal"), (image::ImageShape{70, 70, 3, SampleType::kUint8}));
  EXPECT_EQ(shape("specular"), (image::ImageShape{70, 70, 1, SampleType::kUint8}));
  EXPECT_EQ(shape("roughness"), (image::ImageShape{70, 70, 1, SampleType::kUint8}));
  EXPECT_EQ(shape("displacement"), (image::ImageShape{70, 70, 1, SampleType::kUint16}));
}

std::string topologyOf(const std::string& obj) { return obj.substr(obj.find("vt ")); }

TEST(Synth, MeshesShareTopologyAndUvs) {
  const test::TemporaryDirectory folder;
  synthesize(folder / "a", 64, 3, 1, {"albedo"});
  const std::string neutral = test::contentsOf(folder / "a/neutral.obj");
  for (const auto& entry : fs::directory_iterator(folder / "a/expressions")) {
    const std::string expression = test::contentsOf(entry.path());
    EXPECT_NE(expression, neutral);
    EXPECT_EQ(topologyOf(expression), topologyOf(neutral)) << entry.path();
  }
}

}  // namespace
}  // namespace facezip
