#include "io/staged_directory.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "facezip/error.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

using Existing = io::StagedDirectory::Existing;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(StagedDirectory, AppearsWithCommitAndLeavesNothingElse) {
  const test::TemporaryDirectory folder;
  io::StagedDirectory staged(folder / "a/", Existing::kReplaceMarked, "m.json");
  io::writeTextFile(staged.path() / "m.json", "new");
  EXPECT_FALSE(fs::exists(folder / "a"));
  staged.commit();
  EXPECT_TRUE(fs::exists(folder / "a/m.json"));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(StagedDirectory, WithoutCommitNothingChanges) {
  const test::TemporaryDirectory folder;
  {
    io::StagedDirectory staged(folder / "a", Existing::kReplaceMarked, "m.json");
    io::writeTextFile(staged.path() / "m.json", "new");
  }
  EXPECT_EQ(entries(folder.path()), 0u);
}

TEST(StagedDirectory, ClearedFilesAreNotCommitted) {
  const test::TemporaryDirectory folder;
  io::StagedDirectory staged(folder / "a", Existing::kReplaceMarked, "m.json");
  io::createDirectories(staged.path() / "map");
  io::writeTextFile(staged.path() / "map/stale", "old");
  io::writeTextFile(staged.path() / "stale", "old");
  staged.clear();
  io::writeTextFile(staged.path() / "m.json", "new");
  staged.commit();
  EXPECT_EQ(entries(folder / "a"), 1u);
  EXPECT_TRUE(fs::exists(folder / "a/m.json"));
}

TEST(StagedDirectory, ReplacesItsOwnKindWhole) {
  const test::TemporaryDirectory folder;
  fs::create_directory(folder / "a");
  io::writeTextFile(folder / "a/m.json", "old");
  io::writeTextFile(folder / "a/stale", "old");
  {
    io::StagedDirectory staged(folder / "a", Existing::kReplaceMarked, "m.json");
    io::writeTextFile(staged.path() / "m.json", "new");
    staged.commit();
  }
  EXPECT_FALSE(fs::exists(folder / "a/stale"));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(StagedDirectory, RefusesToReplaceAStranger) {
  const test::TemporaryDirectory folder;
  fs::create_directory(folder / "a");
  io::writeTextFile(folder / "a/holiday.jpg", "precious");
  EXPECT_THROW(io::StagedDirectory(folder / "a", Existing::kReplaceMarked, "m.json"), OutputError);
  io::writeTextFile(folder / "file", "precious");
  EXPECT_THROW(io::StagedDirectory(folder / "file", Existing::kReplaceMarked, "m.json"), OutputError);
  EXPECT_EQ(entries(folder.path()), 2u);
}

TEST(StagedDirectory, MergeKeepsOtherFiles) {
  const test::TemporaryDirectory folder;
  fs::create_directories(folder / "a/x");
  io::writeTextFile(folder / "a/x/keep", "old");
  {
    io::StagedDirectory staged(folder / "a", Existing::kMerge);
    io::createDirectories(staged.path() / "x");
    io::writeTextFile(staged.path() / "x/added", "new");
    staged.commit();
  }
  EXPECT_TRUE(fs::exists(folder / "a/x/keep"));
  EXPECT_TRUE(fs::exists(folder / "a/x/added"));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(WriteTextFile, FullDiskIsAnOutputError) { EXPECT_THROW(io::writeTextFile("/dev/full", "text"), OutputError); }

}  // namespace
}  // namespace facezip
