#include "face/painted_image.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "face/importance.hpp"
#include "facezip/error.hpp"
#include "image/image_file.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
using compress::Importance;
using compress::readPaintedImage;
using testing::ElementsAre;
using testing::FloatEq;

/// A file of two texels side by side.
std::filesystem::path twoTexels(const test::TemporaryDirectory& folder, int channels, const std::vector<int>& samples) {
  image::Image image{{2, 1, channels, image::SampleType::kUint8}, {}};
  for (const int sample : samples) image.samples.push_back(static_cast<std::byte>(sample));
  image::writeImage(folder / "painted.png", image);
  return folder / "painted.png";
}

TEST(PaintedImage, TheBrightestColourCountsAndAlphaDoesNot) {
  const test::TemporaryDirectory folder;
  EXPECT_THAT(readPaintedImage(twoTexels(folder, 1, {51, 255})).brightness, ElementsAre(FloatEq(0.2f), FloatEq(1.0f)));
  EXPECT_THAT(readPaintedImage(twoTexels(folder, 2, {51, 255, 0, 255})).brightness,
              ElementsAre(FloatEq(0.2f), FloatEq(0.0f)));
  EXPECT_THAT(readPaintedImage(twoTexels(folder, 3, {0, 51, 10, 255, 0, 0})).brightness,
              ElementsAre(FloatEq(0.2f), FloatEq(1.0f)));
  EXPECT_THAT(readPaintedImage(twoTexels(folder, 4, {0, 0, 51, 255, 0, 0, 0, 255})).brightness,
              ElementsAre(FloatEq(0.2f), FloatEq(0.0f)));
}

TEST(Importance, IsAHundredthWhereThePaintIsBlack) {
  const test::TemporaryDirectory folder;
  const Importance importance(twoTexels(folder, 4, {255, 0, 0, 0, 0, 0, 0, 255}));
  EXPECT_FLOAT_EQ(importance.at(0, 0, 8, 8), 1.0f) << "the image is stretched over the texture";
  EXPECT_FLOAT_EQ(importance.at(3, 7, 8, 8), 1.0f);
  EXPECT_FLOAT_EQ(importance.at(4, 0, 8, 8), Importance::kLeast);
  EXPECT_THROW(Importance(twoTexels(folder, 2, {0, 255, 0, 255})), InputError) << "black, however opaque";
}

}  // namespace
}  // namespace facezip
