#include "io/staged_directory.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "facezip/error.hpp"
#include "file_contents.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

const io::Footprint kOwn = {"m.json", "ours"};

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(StagedDirectory, AppearsWithCommitAndLeavesNothingElse) {
  const test::TemporaryDirectory folder;
  io::StagedDirectory staged(folder / "a/", kOwn);
  io::writeTextFile(staged.path() / "m.json", "new");
  EXPECT_FALSE(fs::exists(folder / "a"));
  staged.commit();
  EXPECT_TRUE(fs::exists(folder / "a/m.json"));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(StagedDirectory, WithoutCommitNothingChanges) {
  const test::TemporaryDirectory folder;
  {
    io::StagedDirectory staged(folder / "a", kOwn);
    io::writeTextFile(staged.path() / "m.json", "new");
  }
  EXPECT_EQ(entries(folder.path()), 0u);
}

TEST(StagedDirectory, ClearedFilesAreNotCommitted) {
  const test::TemporaryDirectory folder;
  io::StagedDirectory staged(folder / "a", kOwn);
  io::createDirectories(staged.path() / "map");
  io::writeTextFile(staged.path() / "map/stale", "old");
  io::writeTextFile(staged.path() / "stale", "old");
  staged.clear();
  io::writeTextFile(staged.path() / "m.json", "new");
  staged.commit();
  EXPECT_EQ(entries(folder / "a"), 1u);
  EXPECT_TRUE(fs::exists(folder / "a/m.json"));
}

/// Writes "new" as m.json and as map/x.png over `target`.
void replace(const fs::path& target, const io::Footprint& own = kOwn) {
  io::StagedDirectory staged(target, own);
  io::createDirectories(staged.path() / "map");
  io::writeTextFile(staged.path() / "m.json", "ours, new");
  io::writeTextFile(staged.path() / "map/x.png", "new");
  staged.commit();
}

TEST(StagedDirectory, ReplacesItsOwnKindWhole) {
  const test::TemporaryDirectory folder;
  replace(folder / "a");
  io::writeTextFile(folder / "a/map/stale.png", "old");
  io::writeTextFile(folder / "a/m.json", "ours, old");
  replace(folder / "a");
  EXPECT_EQ(test::contentsOf(folder / "a/m.json"), "ours, new");
  EXPECT_FALSE(fs::exists(folder / "a/map/stale.png"));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(StagedDirectory, RefusesToReplaceAStranger) {
  const test::TemporaryDirectory folder;
  fs::create_directory(folder / "a");
  io::writeTextFile(folder / "a/holiday.jpg", "precious");
  EXPECT_THROW(io::StagedDirectory(folder / "a", kOwn), OutputError);
  io::writeTextFile(folder / "a/m.json", "somebody else's");  // the name alone makes it none of ours
  EXPECT_THROW(io::StagedDirectory(folder / "a", kOwn), OutputError);
  io::writeTextFile(folder / "file", "precious");
  EXPECT_THROW(io::StagedDirectory(folder / "file", kOwn), OutputError);
  EXPECT_EQ(entries(folder.path()), 2u);
}

TEST(StagedDirectory, RefusesToReplaceWhatWasLaidIntoItsOwn) {
  const test::TemporaryDirectory folder;
  replace(folder / "a");
  fs::create_directory(folder / "a/src");
  io::writeTextFile(folder / "a/src/notes", "precious");
  EXPECT_THROW(replace(folder / "a"), OutputError);
  EXPECT_EQ(test::contentsOf(folder / "a/src/notes"), "precious");
  EXPECT_EQ(entries(folder.path()), 1u);
  fs::remove_all(folder / "a/src");

  // Where the program knows its files, one more in a folder of its own is a stranger's.
  io::Footprint exact = kOwn;
  exact.files = [](const fs::path&) { return std::vector<fs::path>{"m.json", "map/x.png"}; };
  EXPECT_NO_THROW(replace(folder / "a", exact));
  io::writeTextFile(folder / "a/map/notes", "precious");
  EXPECT_THROW(io::StagedDirectory(folder / "a", exact), OutputError);
  EXPECT_EQ(test::contentsOf(folder / "a/map/notes"), "precious");
}

TEST(StagedDirectory, KeepsWhatEnginesLayBesideFilesThatStay) {
  const test::TemporaryDirectory folder;
  replace(folder / "a");
  io::writeTextFile(folder / "a/map/x.png.meta", "guid");
  io::writeTextFile(folder / "a/map.meta", "guid of the folder");
  replace(folder / "a");
  EXPECT_EQ(test::contentsOf(folder / "a/map/x.png.meta"), "guid");
  EXPECT_EQ(test::contentsOf(folder / "a/map.meta"), "guid of the folder");
  io::writeTextFile(folder / "a/other.meta", "of nothing of ours");
  EXPECT_THROW(replace(folder / "a"), OutputError);
}

TEST(StagedDirectory, CachesOfEnginesGo) {
  const test::TemporaryDirectory folder;
  replace(folder / "a");
  fs::create_directory(folder / "a/.import");
  io::writeTextFile(folder / "a/.import/x.png-0123.stex", "made of x.png");
  EXPECT_NO_THROW(replace(folder / "a"));
  EXPECT_FALSE(fs::exists(folder / "a/.import"));
}

TEST(RequireOutside, KnowsAFolderByEveryName) {
  const test::TemporaryDirectory folder;
  fs::create_directories(folder / "a/b");
  fs::create_directory_symlink("a", folder / "link");
  for (const char* inside : {"a", "a/", "a/b/c/d.png", "link/x.png", "a/../a/x.png", "link/b/.."}) {
    EXPECT_THROW(io::requireOutside(folder / inside, folder / "a", "the package"), OutputError) << inside;
  }
  for (const char* outside : {"x.png", "ab/x.png", "a/../x.png", "link/../x.png"}) {
    EXPECT_NO_THROW(io::requireOutside(folder / outside, folder / "a", "the package")) << outside;
  }
}

TEST(StagedDirectory, ALinkStandsForTheDirectoryItLeadsTo) {
  const test::TemporaryDirectory folder;
  fs::create_directory(folder / "store");
  replace(folder / "store/a");
  fs::create_directory_symlink("store/a", folder / "a");
  io::writeTextFile(folder / "store/a/map/x.png", "old");
  replace(folder / "a");
  EXPECT_TRUE(fs::is_symlink(folder / "a"));
  EXPECT_EQ(test::contentsOf(folder / "store/a/map/x.png"), "new");
  EXPECT_EQ(entries(folder / "store"), 1u);
  fs::create_directory_symlink("nowhere", folder / "b");
  EXPECT_THROW(io::StagedDirectory(folder / "b", kOwn), OutputError);
}

TEST(StagedDirectory, MergeKeepsOtherFiles) {
  const test::TemporaryDirectory folder;
  fs::create_directories(folder / "a/x");
  io::writeTextFile(folder / "a/x/keep", "old");
  {
    io::StagedDirectory staged(folder / "a");
    io::createDirectories(staged.path() / "x");
    io::writeTextFile(staged.path() / "x/added", "new");
    staged.commit();
  }
  EXPECT_TRUE(fs::exists(folder / "a/x/keep"));
  EXPECT_TRUE(fs::exists(folder / "a/x/added"));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(WriteTextFile, GoesThroughLinksAndIntoPipes) {
  const test::TemporaryDirectory folder;
  io::writeTextFile(folder / "file", "old");
  fs::create_symlink("file", folder / "link");
  io::writeTextFileAtomically(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(test::contentsOf(folder / "file"), "new");

  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = test::contentsOf(folder / "pipe"); });
  io::writeTextFileAtomically(folder / "pipe", "through");
  reader.join();
  EXPECT_EQ(read, "through");
  EXPECT_TRUE(fs::is_fifo(folder / "pipe"));
  EXPECT_EQ(entries(folder.path()), 3u);
}

TEST(WriteTextFile, FullDiskIsAnOutputError) { EXPECT_THROW(io::writeTextFile("/dev/full", "text"), OutputError); }

}  // namespace
}  // namespace facezip
