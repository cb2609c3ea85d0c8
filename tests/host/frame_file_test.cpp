#include "facezip/frame_file.hpp"

#include <gtest/gtest.h>

#include "image/image_file.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {

TEST(FramePattern, NumbersFrames) {
  EXPECT_EQ(FramePattern("f/%04d.png", true, 1).file(7, "albedo"), "f/0007.png");
  EXPECT_EQ(FramePattern("f%d.png", true, 1).file(12345, "albedo"), "f12345.png");
  EXPECT_EQ(FramePattern("%02d.png", true, 1).file(123, "albedo"), "123.png");
  EXPECT_EQ(FramePattern("100%.png", false, 1).file(0, "albedo"), "100%.png");
}

TEST(FramePattern, PassesOverPercentSignsThatBeginNone) {
  EXPECT_EQ(FramePattern("50%/f_%04d.png", true, 1).file(7, "albedo"), "50%/f_0007.png");
  EXPECT_EQ(FramePattern("%4d%%d.png", true, 1).file(7, "albedo"), "%4d%7.png");
  EXPECT_EQ(FramePattern("%02d/%d.png", true, 1).file(7, "albedo"), "07/%d.png");
}

TEST(FramePattern, TellsMapsApart) {
  EXPECT_EQ(FramePattern("frame.png", false, 1).file(0, "albedo"), "frame.png");
  EXPECT_EQ(FramePattern("frame.png", false, 2).file(0, "normal"), "frame.normal.png");
  EXPECT_EQ(FramePattern("{map}/{map}_%03d.exr", true, 2).file(5, "normal"), "normal/normal_005.exr");
}

TEST(FramePattern, RefusesWhatCannotTellFramesApart) {
  EXPECT_THROW(FramePattern("frame.png", true, 1), InputError);
  EXPECT_THROW(FramePattern("frame%4d.png", true, 1), InputError);
  EXPECT_THROW(FramePattern("frame", false, 1), InputError);
}

TEST(WriteFrame, AppearsWholeOrNotAtAll) {
  const test::TemporaryDirectory folder;
  PackageMap map;
  map.name = "albedo";
  map.width = 5;
  map.height = 3;
  map.channels = 3;
  const std::vector<std::byte> frame(map.frameBytes(), std::byte{77});
  writeFrame(folder / "new/frame.png", map, frame);
  EXPECT_EQ(image::readImage(folder / "new/frame.png").samples, frame);
  EXPECT_THROW(writeFrame(folder / "frame.nosuchformat", map, frame), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()),
            1);
}

}  // namespace
}  // namespace facezip
