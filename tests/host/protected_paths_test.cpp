#include "facezip/protected_paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/write_file.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

class ProtectedPathsTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "in/maps");
    fs::create_directories(folder_ / "store/elsewhere");
    io::writeTextFile(folder_ / "in/mesh.obj", "mesh");
    io::writeTextFile(folder_ / "in/maps/a.png", "a");
    io::writeTextFile(folder_ / "guess.csv", "guess");
    io::writeTextFile(folder_ / "store/linked.png", "linked");
    fs::create_symlink("../../store/linked.png", folder_ / "in/maps/linked.png");
    fs::create_directory_symlink("../store/elsewhere", folder_ / "in/normal");
    fs::create_directory_symlink("in", folder_ / "link");
    fs::create_hard_link(folder_ / "in/maps/a.png", folder_ / "hard.png");
    fs::create_symlink("guess.csv", folder_ / "guess-link.csv");
    inputs_.add(folder_ / "in", "the capture").add(folder_ / "guess.csv", "the guess").add("", "nothing");
    inputs_.add(folder_ / "out.json", "the other output");
  }

  std::string refusal(const fs::path& output) const {
    try {
      inputs_.requireApart(output, "--report");
      return "";
    } catch (const OutputError& error) {
      return error.what();
    }
  }

  const test::TemporaryDirectory folder_;
  ProtectedPaths inputs_;
};

TEST_F(ProtectedPathsTest, AFolderIsKnownByEveryName) {
  for (const char* inside :
       {"in", "in/", "in/maps/a.png", "in/new.json", "in/new/folder/x.json", "link/x.png", "link", "in/../in/x.png",
        "link/maps/..", "in/normal/x.png", "store/elsewhere/x.png", "store/elsewhere"}) {
    EXPECT_THAT(refusal(folder_ / inside),
                testing::AllOf(testing::HasSubstr("the capture"), testing::HasSubstr("--report")))
        << inside;
  }
  for (const char* outside : {"x.png", "inside/x.png", "in/../x.png", "link/../x.png", "store/x.png", ""}) {
    EXPECT_EQ(refusal(std::string(outside).empty() ? fs::path() : folder_ / outside), "") << outside;
  }
}

TEST_F(ProtectedPathsTest, AFileIsKnownByEveryName) {
  for (const char* same : {"guess.csv", "guess-link.csv", "store/../guess.csv"}) {
    EXPECT_THAT(refusal(folder_ / same), testing::HasSubstr("the guess")) << same;
  }
  for (const char* same : {"hard.png", "store/linked.png"}) {  // of a file in a folder
    EXPECT_THAT(refusal(folder_ / same), testing::HasSubstr("the capture")) << same;
  }
  EXPECT_EQ(refusal(folder_ / "guess.csv.json"), "");
}

TEST_F(ProtectedPathsTest, ALinkToAFolderAboveIsNotAllOfThat) {
  ProtectedPaths inputs;
  fs::create_directory_symlink("..", folder_ / "in/up");
  fs::create_directory_symlink("/", folder_ / "in/root");
  inputs.add(folder_ / "in", "the capture");
  EXPECT_NO_THROW(inputs.requireApart(folder_ / "x.png"));
  EXPECT_THROW(inputs.requireApart(folder_ / "in/up/in/x.png"), OutputError);
}

TEST_F(ProtectedPathsTest, AFolderInThePlaceOfAFileIsLeftToItsReader) {
  ProtectedPaths inputs;
  inputs.addFile(folder_.path(), "the guess").addFile(folder_ / "guess.csv", "the guess");
  EXPECT_NO_THROW(inputs.requireApart(folder_ / "x.png"));
  EXPECT_THROW(inputs.requireApart(folder_ / "guess.csv"), OutputError);
}

TEST_F(ProtectedPathsTest, OtherOutputsAreKnownBeforeTheyAreThere) {
  EXPECT_THAT(refusal(folder_ / "out.json"), testing::HasSubstr("the other output"));
  EXPECT_THAT(refusal(folder_ / "link/../out.json/x"), testing::HasSubstr("the other output"));
}

TEST_F(ProtectedPathsTest, RelativeNamesCountFromHere) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_ / "in/maps");
  EXPECT_NE(refusal("x.png"), "");
  EXPECT_NE(refusal("../x.png"), "");
  EXPECT_EQ(refusal("../../x.png"), "");
  fs::current_path(before);
}

TEST_F(ProtectedPathsTest, DevicesAndPipesAreWrittenTo) {
  EXPECT_EQ(refusal("/dev/null"), "");
  ASSERT_EQ(::mkfifo((folder_ / "in/pipe").c_str(), 0600), 0);
  EXPECT_EQ(refusal(folder_ / "in/pipe"), "");
}

TEST_F(ProtectedPathsTest, AFolderThatIsReplacedMayHoldNoInput) {
  for (const char* around : {"in", "in/maps", "link"}) {
    EXPECT_THROW(inputs_.requireApartFromFolder(folder_ / around), OutputError) << around;
  }
  EXPECT_THROW(inputs_.requireApartFromFolder(folder_.path()), OutputError);
  EXPECT_THROW(inputs_.requireApartFromFolder(folder_ / "store"), OutputError) << "it holds what a link leads to";
  EXPECT_NO_THROW(inputs_.requireApartFromFolder(folder_ / "package"));
}

}  // namespace
}  // namespace facezip
