#include "io/folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <system_error>

#include "facezip/error.hpp"
#include "io/staged_directory.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using io::Folder;
using io::writeTextFile;
using testing::HasSubstr;

class FolderTest : public testing::Test {
 protected:
  FolderTest() {
    fs::create_directories(place() / "map/deep");
    writeTextFile(place() / "a", "file a");
    writeTextFile(place() / "map/b", "file b");
    writeTextFile(place() / "map/deep/c", "file c");
    writeTextFile(temporary_ / "outside", "secret");
  }
  fs::path place() const { return temporary_ / "place"; }

  static std::string messageOf(const Folder& folder, const std::string& name) {
    try {
      folder.open(name, "a file");
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << name << " was opened";
    return "";
  }

  const test::TemporaryDirectory temporary_;
};

TEST_F(FolderTest, OpensFilesInIt) {
  const Folder folder(place());
  EXPECT_EQ(folder.open("a", "a file").read(), "file a");
  EXPECT_EQ(folder.open("map/b", "a file").read(), "file b");
  EXPECT_EQ(folder.open("map/deep/c", "a file").read(), "file c");
  EXPECT_TRUE(folder.has("a"));
  EXPECT_FALSE(folder.has("map"));
  EXPECT_FALSE(folder.has("b"));
  EXPECT_FALSE(folder.wasReplaced());
}

TEST_F(FolderTest, NamesWhatIsNoFile) {
  const Folder folder(place());
  EXPECT_THAT(messageOf(folder, "none"), HasSubstr("place/none: expected a file, got no such file"));
  EXPECT_THAT(messageOf(folder, "none/b"), HasSubstr("no such file"));
  EXPECT_THAT(messageOf(folder, "a/b"), HasSubstr("no such file"));
  EXPECT_THAT(messageOf(folder, "map"), HasSubstr("a folder"));
  ASSERT_EQ(::mkfifo((place() / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(messageOf(folder, "pipe"), HasSubstr("a pipe"));
  EXPECT_THROW(Folder(temporary_ / "none"), std::system_error);
  EXPECT_THROW(Folder(place() / "a"), std::system_error);
}

TEST_F(FolderTest, FollowsNoLinks) {
  const Folder folder(place());
  fs::create_symlink(temporary_ / "outside", place() / "out");
  fs::create_symlink("a", place() / "in");
  fs::create_symlink("none", place() / "nowhere");
  fs::create_directory_symlink(temporary_.path(), place() / "up");
  fs::create_directory_symlink(place() / "map", place() / "other");
  for (const char* name : {"out", "in", "nowhere", "up/outside", "up/place/a", "other/b", "other/deep/c"}) {
    EXPECT_THAT(messageOf(folder, name), HasSubstr("a link")) << name;
  }
  // The folder itself may be named by one.
  fs::create_directory_symlink(place(), temporary_ / "link");
  EXPECT_EQ(Folder(temporary_ / "link").open("map/b", "a file").read(), "file b");
}

TEST_F(FolderTest, StaysTheFolderThatItWas) {
  const Folder folder(place());
  fs::rename(place(), temporary_ / "before");
  fs::create_directory(place());
  writeTextFile(place() / "a", "another");
  EXPECT_TRUE(folder.wasReplaced());
  EXPECT_EQ(folder.open("a", "a file").read(), "file a");
  fs::remove_all(temporary_ / "before");
  EXPECT_EQ(folder.open("a", "a file").read(), "file a") << "what was opened once is there to the end";
  EXPECT_THAT(messageOf(folder, "map/b"), HasSubstr("no such file any more"));
  fs::remove_all(place());
  EXPECT_TRUE(folder.wasReplaced());
}

TEST_F(FolderTest, RefusesFilesThatChangedSinceTheyWereOpened) {
  const Folder folder(place());
  EXPECT_EQ(folder.open("a", "a file").read(), "file a");
  EXPECT_EQ(folder.open("a", "a file").read(), "file a");
  writeTextFile(place() / "a", "file a, longer");
  EXPECT_THAT(messageOf(folder, "a"), HasSubstr("another"));
  // One that is renamed over it is not looked at.
  folder.open("map/b", "a file");
  writeTextFile(place() / "map/new", "something else");
  fs::rename(place() / "map/new", place() / "map/b");
  EXPECT_EQ(folder.open("map/b", "a file").read(), "file b");
}

}  // namespace
}  // namespace facezip
