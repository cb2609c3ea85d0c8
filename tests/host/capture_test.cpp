#include "facezip/capture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/staged_directory.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// The message of the InputError that opening `folder` throws.
std::string failure(const fs::path& folder) {
  try {
    openCapture(folder);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Capture, IsFoundByNames) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "bob", {.expressions = 3, .width = 8, .height = 8, .maps = {"normal", "albedo"}});
  io::writeTextFile(folder / "bob/face_region.txt", "0 1 2");
  const Capture capture = openCapture(folder / "bob");
  EXPECT_EQ(capture.name, "bob");
  EXPECT_THAT(capture.expressions, ElementsAre("e00", "e01", "e02"));
  ASSERT_EQ(capture.maps.size(), 2u);
  EXPECT_EQ(capture.maps[0].name, "albedo");
  EXPECT_EQ(capture.maps[1].expressions[2], folder / "bob/normal/e02.png");
  EXPECT_TRUE(capture.face_region.has_value());
  EXPECT_EQ(capture.unit, "");
}

TEST(Capture, DescriptionDecidesOrderFilesAndWeights) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3, .width = 8, .height = 8});
  fs::create_directory(folder / "c/renders");
  fs::copy_file(folder / "c/albedo/e00.png", folder / "c/renders/beauty.png");
  io::writeTextFile(folder / "c/capture.json", R"({"name": "Bob", "unit": "m", "expressions": ["e02", "smile"],
      "maps": {"albedo": {"colour_space": "sRGB", "weight": 0.5, "expressions": {"smile": "albedo/e00.png"}}}})");
  const Capture capture = openCapture(folder / "c");
  EXPECT_EQ(capture.name, "Bob");
  EXPECT_EQ(capture.unit, "m");
  EXPECT_THAT(capture.expressions, ElementsAre("e02", "smile"));
  ASSERT_EQ(capture.maps.size(), 1u);
  EXPECT_EQ(capture.maps[0].metric_weight, 0.5);
  EXPECT_EQ(capture.maps[0].expressions[1].filename(), "e00.png");
}

TEST(Capture, ImportanceIsFoundOrNamed) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8});
  EXPECT_FALSE(openCapture(folder / "c").importance.has_value());
  fs::copy_file(folder / "c/albedo/e00.png", folder / "c/importance.png");
  EXPECT_EQ(openCapture(folder / "c").importance, folder / "c/importance.png");
  EXPECT_EQ(openCapture(folder / "c").maps.size(), 1u) << "the painted image is no map";
  io::writeTextFile(folder / "c/capture.json", R"({"importance": "albedo/e01.png"})");
  EXPECT_EQ(openCapture(folder / "c").importance, folder / "c/albedo/e01.png");
  io::writeTextFile(folder / "c/capture.json", R"({"importance": 1})");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("importance: expected a string"));
}

TEST(Capture, MapsCanBeChosen) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8, .maps = {"albedo", "normal"}});
  EXPECT_EQ(openCapture(folder / "c", {"normal"}).maps.size(), 1u);
  EXPECT_THROW(openCapture(folder / "c", {"roughness"}), InputError);
}

TEST(Capture, SaysWhatIsMissing) {
  const test::TemporaryDirectory folder;
  EXPECT_THAT(failure(folder / "none"), HasSubstr("no such directory"));
  EXPECT_THAT(failure("/proc/self/cmdline"), HasSubstr("a file"));
  fs::create_directory(folder / "empty");
  EXPECT_THAT(failure(folder / "empty"), HasSubstr("neutral.obj"));

  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8, .maps = {"albedo", "normal"}});
  fs::remove(folder / "c/normal/e01.png");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("e01"));
  fs::remove(folder / "c/albedo/neutral.png");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("neutral.png"));
}

TEST(Capture, RefusesTwoExpressionsOfOneName) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8});
  fs::copy_file(folder / "c/albedo/e00.png", folder / "c/albedo/e00.tif");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("e00.png and e00.tif"));
  fs::remove(folder / "c/albedo/e00.tif");
  io::writeTextFile(folder / "c/capture.json", R"({"expressions": ["e00", "e00"]})");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("the same name twice"));
}

TEST(Capture, MalformedDescriptionNamesTheField) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 8, .height = 8});
  const auto with = [&](const std::string& text) {
    io::writeTextFile(folder / "c/capture.json", text);
    return failure(folder / "c");
  };
  EXPECT_THAT(with("{"), HasSubstr("expected JSON"));
  EXPECT_THAT(with("[]"), HasSubstr("an object"));
  EXPECT_THAT(with(R"({"unit": 3})"), HasSubstr("unit: expected a string"));
  EXPECT_THAT(with(R"({"maps": {"albedo": {"weight": -1}}})"), HasSubstr("maps.albedo.weight"));
  EXPECT_THAT(with(R"({"maps": {"albedo": 3}})"), HasSubstr("maps.albedo"));
  EXPECT_THAT(with(R"({"expressions": "e00"})"), HasSubstr("expressions: expected an array"));
  EXPECT_THAT(with(R"({"expressions": [3]})"), HasSubstr("expressions[0]: expected a string"));
  EXPECT_THAT(with(R"({"maps": {"albedo": {"expressions": {"e00": 3}}}})"),
              HasSubstr("maps.albedo.expressions.e00: expected a string"));
  EXPECT_THAT(with(R"({"maps": {"albedo": {"weight": 1e999}}})"), HasSubstr("capture.json: expected"));
  EXPECT_THAT(with(std::string(1000, '[')), HasSubstr("nested"));
  fs::remove(folder / "c/capture.json");
  fs::create_directory(folder / "c/capture.json");
  EXPECT_THAT(failure(folder / "c"), HasSubstr("a folder"));
}

}  // namespace
}  // namespace facezip
