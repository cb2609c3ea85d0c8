#include "image/sample_bands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stop_token>
#include <thread>

#include "facezip/capture.hpp"
#include "small_capture.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {

std::vector<std::byte> collect(image::SampleBands& bands, int band_rows) {
  Progress progress;
  std::vector<std::byte> all;
  bands.forEachBand(band_rows, progress, [&](const image::SampleBand& band) {
    all.insert(all.end(), band.samples.begin(), band.samples.end());
  });
  return all;
}

TEST(SampleBands, EveryPassGivesTheSameSamplesFromDiskAndFromScratch) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3, .width = 33, .height = 41});
  const Capture capture = openCapture(folder / "c");
  image::SampleBands decoded(capture.maps[0], capture.expressions);
  image::SampleBands kept(capture.maps[0], capture.expressions);
  kept.keepDecoded(folder.path());
  std::jthread decoder([&](const std::stop_token& stop) { kept.decode(stop); });
  const auto first = collect(decoded, 16);
  EXPECT_EQ(first.size(), decoded.decodedBytes());
  EXPECT_EQ(collect(decoded, 16), first) << "decoded again";
  EXPECT_EQ(collect(kept, 16), first) << "first pass, while textures are decoded";
  decoder.join();
  std::filesystem::remove(capture.maps[0].expressions[1]);
  EXPECT_EQ(collect(kept, 16), first) << "second pass reads no texture";
}

TEST(SampleBands, PassesThrowWhatDecodingMet) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3, .width = 200, .height = 300});
  const Capture capture = openCapture(folder / "c");
  const auto& damaged = capture.maps[0].expressions[1];
  std::filesystem::resize_file(damaged, std::filesystem::file_size(damaged) / 2);
  image::SampleBands bands(capture.maps[0], capture.expressions);
  bands.keepDecoded(folder.path());
  std::jthread decoder([&](const std::stop_token& stop) { bands.decode(stop); });
  EXPECT_THROW(collect(bands, 16), InputError);
}

TEST(SampleBands, SayWhichFilesSayOtherThingsOfTheirColours) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 3, .width = 16, .height = 16});
  const Capture capture = openCapture(folder / "c");
  EXPECT_EQ(image::SampleBands(capture.maps[0], capture.expressions).mixedColours(), "");
  for (const int n : {1, 2}) {
    const auto& file = capture.maps[0].expressions[static_cast<std::size_t>(n)];
    image::writeImage(file, image::readImage(file), "linear");
  }
  const std::string mixed = image::SampleBands(capture.maps[0], capture.expressions).mixedColours();
  EXPECT_THAT(mixed,
              testing::HasSubstr("map \"albedo\": of its colours neutral.png says nothing, e01.png says linear"));
  EXPECT_THAT(mixed, testing::HasSubstr("1 more"));
}

TEST(SampleBands, FirstImageIsTheNeutral) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 16, .height = 16});
  const Capture capture = openCapture(folder / "c");
  image::SampleBands bands(capture.maps[0], capture.expressions);
  const auto samples = collect(bands, 16);
  const auto neutral = image::readImage(capture.maps[0].neutral).samples;
  EXPECT_TRUE(std::equal(neutral.begin(), neutral.end(), samples.begin()));
}

TEST(SampleBands, RefusesTexturesUnlikeTheNeutral) {
  struct Case {
    image::ImageShape shape;
    const char* cure;
  };
  for (const Case& wrong : {Case{{40, 32, 3, image::SampleType::kUint8}, "resize"},
                            Case{{32, 32, 1, image::SampleType::kUint8}, "export both alike"},
                            Case{{32, 32, 3, image::SampleType::kUint16}, "export both alike"}}) {
    const test::TemporaryDirectory folder;
    test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 32, .height = 32});
    const Capture capture = openCapture(folder / "c");
    image::writeImage(capture.maps[0].expressions[1], test::makeImage(wrong.shape, [](int, int, int) { return 1.0; }));
    try {
      const image::SampleBands bands(capture.maps[0], capture.expressions);
      FAIL() << "expected InputError";
    } catch (const InputError& error) {
      EXPECT_NE(error.parts().item.find("e01"), std::string::npos);
      EXPECT_NE(error.parts().cure.find(wrong.cure), std::string::npos) << error.what();
    }
  }
}

TEST(SampleBands, CancelStopsThePass) {
  const test::TemporaryDirectory folder;
  test::writeSmallCapture(folder / "c", {.expressions = 2, .width = 32, .height = 64});
  const Capture capture = openCapture(folder / "c");
  image::SampleBands bands(capture.maps[0], capture.expressions);
  Progress progress;
  int visited = 0;
  EXPECT_THROW(bands.forEachBand(16, progress,
                                 [&](const image::SampleBand&) {
                                   ++visited;
                                   progress.cancel();
                                 }),
               Cancelled);
  EXPECT_EQ(visited, 1);
}

}  // namespace
}  // namespace facezip
