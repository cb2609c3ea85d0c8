#include "facezip/input_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "../special_file.hpp"
#include "../temporary_directory.hpp"
#include "facezip/error.hpp"
#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/obj_io.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

TEST(InputFile, IsReadFromItsFirstByteToItsLast) {
  const test::TemporaryDirectory folder;
  for (const std::size_t size : {0u, 1u, 65535u, 65536u, 65537u, 300000u}) {
    const std::string text(size, 'x');
    write(folder / "file", text);
    const InputFile file(folder / "file", "a file");
    EXPECT_EQ(file.size(), size);
    EXPECT_EQ(file.read(), text);
    EXPECT_EQ(file.read(size), text) << "once more";
    if (size > 0) {
      EXPECT_THROW(file.read(size - 1), InputError);
    }
  }
  EXPECT_NE(InputFile("/proc/self/status", "a file").read().find("Name:"), std::string::npos) << "it claims no bytes";
}

TEST(InputFile, MayGrowAndBeReplacedMeanwhile) {
  const test::TemporaryDirectory folder;
  write(folder / "file", "old");
  const InputFile file(folder / "file", "a file");
  std::ofstream(folder / "file", std::ios::app) << " and more";
  EXPECT_EQ(file.read(), "old and more");
  EXPECT_THROW(file.read(3), InputError);
  write(folder / "other", "new");
  fs::rename(folder / "other", folder / "file");
  EXPECT_EQ(file.read(), "old and more");
}

TEST(InputFile, NothingButRegularFilesIsOpened) {
  for (const test::SpecialFile& special : test::specialFiles()) {
    const test::TemporaryDirectory folder;
    special.put(folder / "file");
    EXPECT_THAT(faultOfFile(folder / "file"), testing::HasSubstr(special.name));
    try {
      InputFile(folder / "file", "a table", "make one");
      FAIL() << special.name;
    } catch (const InputError& error) {
      EXPECT_THAT(error.parts().got, testing::HasSubstr(special.name));
      EXPECT_EQ(error.parts().expected, "a table");
      EXPECT_EQ(error.parts().cure, "make one");
    }
    EXPECT_THROW(geometry::readObj(folder / "file"), InputError);
    EXPECT_THROW(geometry::readTriangleIndices(folder / "file", 3), InputError);
  }
  EXPECT_EQ(faultOfFile("/nowhere/file"), "no such file");
  EXPECT_EQ(faultOfFile("/proc/self/status"), "");
}

TEST(InputFile, LinksAreFollowed) {
  const test::TemporaryDirectory folder;
  write(folder / "file", "text");
  fs::create_symlink("file", folder / "link");
  EXPECT_EQ(InputFile(folder / "link", "a file").read(), "text");
}

TEST(InputFile, MeshesThatAreNoFilesAreNotLeftOut) {
  for (const test::SpecialFile& special : test::specialFiles()) {
    const test::TemporaryDirectory folder;
    special.put(folder / "smile.obj");
    EXPECT_EQ(geometry::objFiles(folder.path()), std::vector<fs::path>{folder / "smile.obj"}) << special.name;
  }
}

}  // namespace
}  // namespace facezip
