// The worked example of docs/package_format.md: its JSON, images and numbers, without facezip's writer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <span>

#include "blend/band_blender.hpp"
#include "blend_frame.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "temporary_directory.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using test::blendFrame;
using test::testDevice;

/// An image of equal rows.
image::Image grayRows(int width, int height, int channels, const std::vector<int>& row,
                      SampleType type = SampleType::kUint8) {
  image::Image image{{width, height, channels, type}, {}};
  for (int y = 0; y < height; ++y) {
    for (const int code : row) {
      const auto wide = static_cast<std::uint16_t>(code);
      const auto bytes = std::as_bytes(std::span(&wide, 1));  // little-endian, as every OpenCL device today
      image.samples.insert(image.samples.end(), bytes.begin(), bytes.begin() + image::sampleBytes(type));
    }
  }
  return image;
}

/// One row of what a renderer sees of a map before rounding.
std::vector<float> valuesOfRow0(const Package& package, int map, const std::vector<float>& beta) {
  const PackageMap& described = package.maps()[static_cast<std::size_t>(map)];
  blend::BandBlender bands(package, map, blend::loadWeightMaps(package, testDevice()), testDevice());
  bands.loadRows(0, described.height);
  std::vector<float> values(static_cast<std::size_t>(described.height * described.width * described.channels));
  bands.blendValues(beta, values);
  values.resize(static_cast<std::size_t>(described.width * described.channels));
  return values;
}

/// The images of the example.
void writeExampleImages(const std::filesystem::path& folder) {
  io::createDirectories(folder / "albedo");
  image::writeImage(folder / "albedo/weights.png",
                    grayRows(8, 3, 2, {255, 128, 255, 128, 0, 128, 0, 128, 0, 192, 0, 192, 255, 64, 255, 64}));
  std::vector<int> neutral;
  for (int x = 0; x < 16; ++x) neutral.push_back(100 + x);
  image::writeImage(folder / "albedo/neutral.png", grayRows(16, 8, 1, neutral));
  image::writeImage(folder / "albedo/difference_0.png", grayRows(16, 8, 1, std::vector<int>(16, 148)));
  image::writeImage(folder / "albedo/difference_1.png", grayRows(16, 8, 1, std::vector<int>(16, 118)));
  io::createDirectories(folder / "gloss");
  image::writeImage(folder / "gloss/weights.png",
                    grayRows(6, 3, 2, {128, 64, 128, 64, 128, 64, 64, 32, 64, 32, 64, 32}));
  image::writeImage(folder / "gloss/neutral.png", grayRows(4, 2, 1, std::vector<int>(4, 50)));
  image::writeImage(folder / "gloss/difference_0.png",
                    grayRows(4, 2, 1, std::vector<int>(4, 35349), SampleType::kUint16));
  image::writeImage(folder / "gloss/difference_1.png",
                    grayRows(4, 2, 1, {20000, 20300, 20600, 20900}, SampleType::kUint16));
}

constexpr char kExampleJson[] = R"({
  "format": "facezip-package", "version": 2, "generator": "by hand", "name": "example",
  "expressions": ["smile", "jawOpen"], "differences": 2,
  "weights": [
    {"files": ["albedo/weights.png"], "columns": 2, "rows": 1, "tile_width": 2, "tile_height": 1, "border": 1,
     "scale": [0.00392156862745098, 0.0078125], "offset": [0, -1]},
    {"files": ["gloss/weights.png"], "columns": 2, "rows": 1, "tile_width": 1, "tile_height": 1, "border": 1,
     "scale": [0.0078125, 0.0078125], "offset": [0, 0]}],
  "maps": [
    {"name": "albedo", "width": 16, "height": 8, "channels": 1, "sample_type": "8-bit", "colour_space": "sRGB",
     "weights": 0, "weight_scale": 8, "metric_weight": 1, "neutral": {"file": "albedo/neutral.png"},
     "difference_bits": 8,
     "differences": [{"file": "albedo/difference_0.png", "scale": [0.5], "offset": [-64]},
                     {"file": "albedo/difference_1.png", "scale": [1.0], "offset": [-128]}]},
    {"name": "gloss", "width": 4, "height": 2, "channels": 1, "sample_type": "8-bit", "colour_space": "linear",
     "weights": 1, "weight_scale": 4, "metric_weight": 1, "neutral": {"file": "gloss/neutral.png"},
     "difference_bits": 16,
     "differences": [{"file": "gloss/difference_0.png", "scale": [0.00390625], "offset": [-128]},
                     {"file": "gloss/difference_1.png", "scale": [0.00390625], "offset": [0]}]}],
  "method": {}})";

TEST(PackageFormat, WorkedExampleGivesItsTestVectors) {
  const test::TemporaryDirectory folder;
  io::writeTextFile(folder / "package.json", kExampleJson);
  writeExampleImages(folder.path());
  const Package package = Package::open(folder.path());
  Blender blender(package, testDevice());
  const std::vector<int> albedo = {100, 101, 102, 103, 105, 108, 111, 114, 116, 119, 122, 125, 127, 128, 129, 130};
  EXPECT_EQ(blendFrame(blender, package, 0, {0.5f, 1.0f}), grayRows(16, 8, 1, albedo).samples);
  EXPECT_THAT(valuesOfRow0(package, 0, {0.5f, 1.0f}),
              testing::Pointwise(testing::FloatNear(1e-4f),
                                 {100.0f, 101.0f, 102.0f, 103.0f, 104.9375f, 107.8125f, 110.6875f, 113.5625f, 116.4375f,
                                  119.3125f, 122.1875f, 125.0625f, 127.0f, 128.0f, 129.0f, 130.0f}));
  const std::vector<std::byte> neutral = image::readImage(folder / "albedo/neutral.png").samples;
  EXPECT_EQ(blendFrame(blender, package, 0, {0.0f, 0.0f}), neutral);
  EXPECT_EQ(blendFrame(blender, package, 0, {100.0f, 0.0f})[0], std::byte{255});
  EXPECT_NEAR(valuesOfRow0(package, 0, {100.0f, 0.0f})[0], 1100.0f, 1e-3f);
  EXPECT_EQ(blendFrame(blender, package, 0, {-100.0f, 0.0f})[0], std::byte{0});
  EXPECT_NEAR(valuesOfRow0(package, 0, {-100.0f, 0.0f})[0], -900.0f, 1e-3f);
  EXPECT_EQ(blendFrame(blender, package, 1, {0.5f, 1.0f}), grayRows(4, 2, 1, {99, 100, 100, 101}).samples);
  EXPECT_THAT(
      valuesOfRow0(package, 1, {0.5f, 1.0f}),
      testing::Pointwise(testing::FloatNear(1e-5f), {99.14453125f, 99.73046875f, 100.31640625f, 100.90234375f}));
}

}  // namespace
}  // namespace facezip
