// Weights as users give them: by name, as text, as a clip.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "blend/names.hpp"
#include "facezip/blend.hpp"
#include "facezip/nearest_names.hpp"
#include "file_contents.hpp"
#include "io/staged_directory.hpp"
#include "notes.hpp"
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

// One blendshape has many names; the table is data (host/data/shape_names.json).
TEST(WeightsByName, KnowsOtherNamesOfAShape) {
  const test::TemporaryDirectory folder;
  const Package package =
      packageOf(folder, {"mouthSmile_L", "mouthSmile_R", "jawOpen", "AU4", "browInnerUp", "Sourire"});
  using Weights = std::vector<float>;
  const auto weights = [&](const std::string& text) { return weightsByName(package, parseWeights(text)); };
  EXPECT_EQ(weights("mouthSmileLeft=1,MouthSmileRight=2,JawOpen=3"), (Weights{1, 2, 3, 0, 0, 0}));
  EXPECT_EQ(weights("AU12L=1,au26=2,sourire=3"), (Weights{1, 0, 2, 0, 0, 3}));
  EXPECT_EQ(weights("AU12=1"), (Weights{1, 1, 0, 0, 0, 0})) << "both sides by the name of both";
  EXPECT_EQ(weights("browDownLeft=0.5,browDown_R=1"), (Weights{0, 0, 0, 0.75f, 0, 0}))
      << "both sides of one expression";
  EXPECT_EQ(weights("BROWDOWN=1"), (Weights{0, 0, 0, 1, 0, 0})) << "both are names of both sides";
  EXPECT_EQ(weights("browInnerUp_L=1"), (Weights{0, 0, 0, 0, 0.5f, 0}));
  // Exact names, then names of one shape, then those of several.
  EXPECT_EQ(weights("AU12=1,mouthSmile_L=0.5"), (Weights{0.5f, 1, 0, 0, 0, 0}));
}

TEST(WeightsByName, RefusesAShapeUnderTwoNames) {
  const test::TemporaryDirectory folder;
  const Package package = packageOf(folder, {"mouthSmile_L", "jawOpen", "JAWOPEN"});
  const auto failure = [&](const std::string& text) {
    try {
      weightsByName(package, parseWeights(text));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(failure("mouthSmileLeft=1,AU12L=1"), HasSubstr("\"mouthSmileLeft\" and \"AU12L\""));
  EXPECT_THAT(failure("mouthSmile_L=1,AU12L=1"), HasSubstr("\"AU12L\"; the nearest are"));
  EXPECT_EQ(failure("jawOpen=1,JAWOPEN=1"), "no error") << "the package tells them apart";
  EXPECT_THAT(failure("JawOpen=1"), HasSubstr("\"JawOpen\"; the nearest are jawOpen, JAWOPEN"));
}

// macOS takes accents off the letters, in names of files and so of expressions; keyboards do not.
TEST(WeightsByName, ComparesNamesAsTheyLook) {
  const test::TemporaryDirectory folder;
  const Package package = packageOf(folder, {"cafe\u0301", "na\u00efve"});
  EXPECT_EQ(package.expressions()[0], "caf\u00e9");
  EXPECT_EQ(weightsByName(package, {{"caf\u00e9", 1.0f}, {"nai\u0308ve", 2.0f}}), (std::vector<float>{1.0f, 2.0f}));
  EXPECT_EQ(weightsByName(package, {{"cafe\u0301", 3.0f}}), (std::vector<float>{3.0f, 0.0f}));
  std::string text = test::contentsOf(folder / "package/package.json");
  for (const char* name : {"caf\u00e9", "na\u00efve"}) {
    text.replace(text.find(name), std::string(name).size(), name[0] == 'c' ? "\u00e9" : "e\u0301");
  }
  io::writeTextFile(folder / "package/package.json", text);
  EXPECT_THROW(Package::open(folder / "package"), InputError) << "two names that look the same";
}

TEST(EditDistance, CountsEditsSwapsAndNotCase) {
  EXPECT_EQ(editDistance("", "abc"), 3);
  EXPECT_EQ(editDistance("kitten", "sitting"), 3);
  EXPECT_EQ(editDistance("JAWOPEN", "jawOpen"), 0);
  EXPECT_EQ(editDistance("jawOpne", "jawOpen"), 1);
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
    notes_.all.clear();
    return readAnimation(folder_ / "clip.csv", package_, &notes_);
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
  test::Notes notes_;
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

// As Live Link Face writes clips: time, a count, ARKit's shapes with a capital, turns of head and eyes.
TEST_F(Animation, OfAFaceTrackerIsRead) {
  const AnimationClip clip = read(
      "Timecode,BlendShapeCount,JawOpen,MouthSmileLeft,HeadYaw,LeftEyePitch\n"
      "17:24:45:19.535,61,0.25,0.5,-0.1,x\n"
      "17:24:45:20.535,0\n"
      "17:24:45:21.535,61,0.75,0.5,-0.1,x\n");
  ASSERT_EQ(clip.frames(), 3);
  EXPECT_THAT(clip.weights, testing::ElementsAre(0, 0.25f, 0, 0, 0.25f, 0, 0, 0.75f, 0)) << "no face: as before";
  EXPECT_THAT(notes_.all,
              testing::ElementsAre(HasSubstr("no expression is called so: \"MouthSmileLeft\" (the nearest")));
  read("Timecode,BlendShapeCount,JawOpen\n1,0,0.5\n");
  EXPECT_TRUE(notes_.all.empty()) << notes_.all[0];
}

TEST_F(Animation, NotesColumnsThatDriveNothing) {
  EXPECT_EQ(read("smile,frown,,jawOpne\n1,what,,ever\n").weights, (std::vector<float>{1, 0, 0}));
  EXPECT_THAT(notes_.all,
              testing::ElementsAre(testing::AllOf(HasSubstr("clip.csv: columns skipped"),
                                                  HasSubstr("\"frown\", \"jawOpne\" (the nearest to the first"))));
  read("smile,a,b,c,d,e,f,g,h,i,j\n1,1,1,1,1,1,1,1,1,1,1\n");
  EXPECT_THAT(notes_.all, testing::ElementsAre(HasSubstr("\"g\", \"h\" and 2 more (")));
}

TEST_F(Animation, NotesPerCent) {
  read("smile\n2\n-2\n");
  EXPECT_TRUE(notes_.all.empty());
  read("frame,smile,jawOpen\n1000,0,0\n1001,70,-80\n");
  EXPECT_THAT(notes_.all, testing::ElementsAre(HasSubstr("weights up to -80 (line 3, column 3): 1 is the whole")));
}

TEST_F(Animation, NamesFileLineAndColumn) {
  EXPECT_THAT(messageOf("smile\n0.5\nx\n"),
              HasSubstr("clip.csv: line 3, column 1: expected a number of at most 1e+06 either way, got \"x\""));
  EXPECT_THAT(
      messageOf("frame,frown\n1,2\n"),
      HasSubstr("line 1: expected names of expressions of the package, got \"frame,frown\"; the nearest to \"frown\""));
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
