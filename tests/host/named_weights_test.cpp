// Weights as users give them: by name, as text, as a clip.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "blend/names.hpp"
#include "facezip/blend.hpp"
#include "io/staged_directory.hpp"
#include "sample_package.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
using test::SamplePackage;
using testing::HasSubstr;

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
  // What is too small for a float is not too strange for a weight.
  EXPECT_EQ(parseWeights("a=1e-50,b=-1e-50,c=1e-400,d=1e-40"),
            (Pairs{{"a", 0.0f}, {"b", 0.0f}, {"c", 0.0f}, {"d", 1e-40f}}));
  for (const char* text : {"smile", "smile=", "=1", "smile=x", "smile=1,", "smile=1 2", "smile=nan", "smile=1e99",
                           "smile=1e999", "smile=-1e39", "smile=0,7"}) {
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

TEST_F(Animation, NamesOfThePackageGoBeforeColumnsOfTime) {
  const test::TemporaryDirectory folder;
  const Package package = packageOf(folder, {"time", "smile", "Frame"});
  io::writeTextFile(folder / "clip.csv", "frame,time,Frame,TIME,smile\n7,0.5,0.25,8,1\n");
  const AnimationClip clip = readAnimation(folder / "clip.csv", package);
  EXPECT_THAT(clip.frame(0), testing::ElementsAre(0.5f, 1.0f, 0.25f));
}

TEST_F(Animation, NamesFileLineAndColumn) {
  EXPECT_THAT(messageOf("smile\n0.5\nx\n"),
              HasSubstr("clip.csv: line 3, column 1: expected a number of at most 1e+06 either way, got \"x\""));
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
