#include "io/staged_directory.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
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
void replace(const fs::path& target, const io::Footprint& own = kOwn, Progress* progress = nullptr) {
  io::StagedDirectory staged(target, own, progress);
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

/// Keeps the notes.
class Notes : public Progress {
 public:
  void note(std::string_view message) override { text += std::string(message) + "\n"; }
  std::string text;
};

/// Runs `write`, which kills itself amid the work, in a process of its own.
template <typename Write>
void killAmid(const Write& write) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    write();
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << status;
}

TEST(StagedDirectory, WhatAKilledRunLeftIsRemovedAndNoted) {
  const test::TemporaryDirectory folder;
  replace(folder / "a");
  killAmid([&] {
    const io::StagedDirectory staged(folder / "a", kOwn);
    io::writeTextFile(staged.path() / "m.json", "ours, half");
    ::raise(SIGKILL);
  });
  EXPECT_EQ(entries(folder.path()), 2u);
  EXPECT_EQ(test::contentsOf(folder / "a/m.json"), "ours, new");
  // Names that are none of ours, though they begin alike.
  for (const char* name : {".a.partial-1.partial-2-0", ".ab.partial-1-0", ".a.partial-x-0", ".a.partial-1-"}) {
    fs::create_directory(folder / name);
  }
  Notes notes;
  replace(folder / "a", kOwn, &notes);
  EXPECT_NE(notes.text.find("left from a run that was killed"), std::string::npos) << notes.text;
  EXPECT_EQ(entries(folder.path()), 5u);
  EXPECT_EQ(test::contentsOf(folder / "a/m.json"), "ours, new");
}

TEST(StagedDirectory, RunsAtWorkAreLeftAlone) {
  const test::TemporaryDirectory folder;
  io::StagedDirectory first(folder / "a", kOwn);
  io::writeTextFile(first.path() / "m.json", "ours, first");
  Notes notes;
  io::StagedDirectory second(folder / "a", kOwn, &notes);
  EXPECT_EQ(notes.text, "");
  EXPECT_TRUE(fs::exists(first.path() / "m.json"));
  io::writeTextFile(second.path() / "m.json", "ours, second");
  first.commit();
  // Who comes second says so, and takes nothing away.
  for (const bool was_there : {false, true}) {
    try {
      if (was_there) {
        io::StagedDirectory third(folder / "a", kOwn);
        io::writeTextFile(third.path() / "m.json", "ours, third");
        replace(folder / "a");
        third.commit();
      } else {
        second.commit();
      }
      FAIL();
    } catch (const OutputError& error) {
      EXPECT_NE(std::string(error.what()).find("another run"), std::string::npos) << error.what();
    }
    EXPECT_EQ(test::contentsOf(folder / "a/m.json"), was_there ? "ours, new" : "ours, first");
  }
}

TEST(StagedDirectory, WhatWasMovedAwayByAKilledRunComesBack) {
  const test::TemporaryDirectory folder;
  replace(folder / "a");
  fs::rename(folder / "a", io::replacedName(folder / "a"));
  Notes notes;
  { const io::StagedDirectory staged(folder / "a", kOwn, &notes); }
  EXPECT_EQ(test::contentsOf(folder / "a/m.json"), "ours, new");
  EXPECT_NE(notes.text.find("brought back"), std::string::npos);
  EXPECT_EQ(entries(folder.path()), 1u);
  fs::create_directory(io::replacedName(folder / "a"));  // the killed run had put the new one in place
  { const io::StagedDirectory staged(folder / "a", kOwn, &notes); }
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(StagedDirectory, NamesAsLongAsTheFileSystemTakes) {
  const test::TemporaryDirectory folder;
  for (const std::size_t length : {190u, 194u, 195u, 196u, 240u, 255u}) {
    const std::string name = std::string(length - 2, 'x') + "\xc3\xa4";
    replace(folder / name);
    replace(folder / name);
    EXPECT_EQ(entries(folder.path()), 1u);
    fs::remove_all(folder / name);
    io::writeTextFileAtomically(folder / name, "text");
    EXPECT_EQ(test::contentsOf(folder / name), "text");
    fs::remove(folder / name);
  }
  // Two long names that begin alike have hidden names of their own.
  const std::string start(240, 'x');
  EXPECT_NE(io::hiddenStem(folder / (start + "a")), io::hiddenStem(folder / (start + "b")));
}

TEST(StagedDirectory, MergingMovesAllFilesOrNone) {
  const test::TemporaryDirectory folder;
  fs::create_directories(folder / "a/x/second.png");  // in the way
  {
    io::StagedDirectory staged(folder / "a");
    io::createDirectories(staged.path() / "x");
    io::writeTextFile(staged.path() / "x/first.png", "new");
    io::writeTextFile(staged.path() / "x/second.png", "new");
    EXPECT_THROW(staged.commit(), OutputError);
  }
  EXPECT_FALSE(fs::exists(folder / "a/x/first.png"));
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(StagedFile, AppearsWithCommitAndTakesTheNameOfAKilledRun) {
  const test::TemporaryDirectory folder;
  io::writeTextFile(folder / "x.png", "old");
  fs::path left;
  killAmid([&] {
    const io::StagedFile staged(folder / "x.png");
    io::writeTextFile(staged.path(), "half");
    ::raise(SIGKILL);
  });
  EXPECT_EQ(entries(folder.path()), 2u);
  Notes notes;
  io::StagedFile staged(folder / "x.png", &notes);
  EXPECT_EQ(staged.path().extension(), ".png");
  EXPECT_EQ(entries(folder.path()), 2u);
  EXPECT_NE(notes.text.find("left from a run that was killed"), std::string::npos) << notes.text;
  {
    const io::StagedFile second(folder / "x.png", &notes);  // while the first is at work
    EXPECT_NE(second.path(), staged.path());
  }
  io::writeTextFile(staged.path(), "new");
  EXPECT_EQ(test::contentsOf(folder / "x.png"), "old");
  staged.commit();
  EXPECT_EQ(test::contentsOf(folder / "x.png"), "new");
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(StagedFile, WritesThroughNoTrap) {
  const test::TemporaryDirectory folder;
  io::writeTextFile(folder / "precious", "precious");
  const fs::path name = [&] { return io::StagedFile(folder / "x.json").path(); }();
  fs::create_hard_link(folder / "precious", name);
  io::writeTextFileAtomically(folder / "x.json", "new");
  fs::remove(name);
  fs::create_symlink("precious", name);
  io::writeTextFileAtomically(folder / "x.json", "new");
  fs::remove(name);
  ASSERT_EQ(::mkfifo(name.c_str(), 0600), 0);
  io::writeTextFileAtomically(folder / "x.json", "new");
  EXPECT_EQ(test::contentsOf(folder / "precious"), "precious");
  EXPECT_EQ(test::contentsOf(folder / "x.json"), "new");
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
