#include "image/image_file.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <numeric>
#include <thread>
#include <vector>

#include "facezip/error.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {

image::Image ramp(int width, int height, int channels, image::SampleType type) {
  image::Image image{{width, height, channels, type}, {}};
  image.samples.resize(static_cast<std::size_t>(height) * image.shape.rowBytes());
  const std::size_t count = image.samples.size() / image::sampleBytes(type);
  for (std::size_t i = 0; i < count; ++i) {
    if (type == image::SampleType::kUint8) {
      image.samples[i] = static_cast<std::byte>(i * 7);
    } else if (type == image::SampleType::kUint16) {
      reinterpret_cast<std::uint16_t*>(image.samples.data())[i] = static_cast<std::uint16_t>(i * 977);
    } else {
      reinterpret_cast<float*>(image.samples.data())[i] = 0.01f * static_cast<float>(i) - 1.0f;
    }
  }
  return image;
}

struct FileCase {
  const char* name;
  int channels;
  image::SampleType type;
};

class ImageFile : public testing::TestWithParam<FileCase> {};

TEST_P(ImageFile, BandsOfAnyHeightGiveTheSamplesWritten) {
  const test::TemporaryDirectory folder;
  const image::Image image = ramp(37, 21, GetParam().channels, GetParam().type);
  image::writeImage(folder / GetParam().name, image);
  for (const int band : {1, 4, 21}) {
    image::ImageReader reader(folder / GetParam().name);
    ASSERT_EQ(reader.shape(), image.shape);
    std::vector<std::byte> rows(image.samples.size());
    for (int begin = 0; begin < 21; begin += band) {
      const int end = std::min(begin + band, 21);
      const std::size_t offset = static_cast<std::size_t>(begin) * image.shape.rowBytes();
      reader.readRows(begin, end,
                      std::span(rows).subspan(offset, static_cast<std::size_t>(end - begin) * image.shape.rowBytes()));
    }
    EXPECT_EQ(rows, image.samples) << "band of " << band << " rows";
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageFile,
                         testing::Values(FileCase{"g8.png", 1, image::SampleType::kUint8},
                                         FileCase{"rgb8.png", 3, image::SampleType::kUint8},
                                         FileCase{"rgba8.png", 4, image::SampleType::kUint8},
                                         FileCase{"rgb16.png", 3, image::SampleType::kUint16},
                                         FileCase{"rgb16.tif", 3, image::SampleType::kUint16},
                                         FileCase{"rgb.exr", 3, image::SampleType::kFloat32},
                                         FileCase{"g.tif", 1, image::SampleType::kFloat32}),
                         [](const auto& file_case) {
                           std::string name = file_case.param.name;
                           name[name.find('.')] = '_';
                           return name;
                         });

TEST(ImageWriter, FilesDoNotDependOnTheTimeOfWriting) {
  const test::TemporaryDirectory folder;
  for (const FileCase& file :
       {FileCase{"a.png", 3, image::SampleType::kUint8}, FileCase{"a.exr", 3, image::SampleType::kFloat32}}) {
    const auto bytes = [&] {
      image::writeImage(folder / file.name, ramp(9, 9, file.channels, file.type));
      std::ifstream stream(folder / file.name, std::ios::binary);
      return std::string(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    };
    const std::string first = bytes();
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // headers count in seconds
    EXPECT_EQ(bytes(), first) << file.name;
  }
}

TEST(ImageReader, GoesBackToEarlierRows) {
  const test::TemporaryDirectory folder;
  const image::Image image = ramp(5, 40, 3, image::SampleType::kUint8);
  image::writeImage(folder / "a.png", image);
  image::ImageReader reader(folder / "a.png");
  std::vector<std::byte> row(image.shape.rowBytes());
  reader.readRows(30, 31, row);
  reader.readRows(2, 3, row);
  EXPECT_EQ(std::memcmp(row.data(), image.samples.data() + 2 * image.shape.rowBytes(), row.size()), 0);
}

TEST(ImageReader, TruncatedPngNamesTheFile) {
  const test::TemporaryDirectory folder;
  image::writeImage(folder / "a.png", ramp(64, 64, 3, image::SampleType::kUint8));
  std::filesystem::resize_file(folder / "a.png", std::filesystem::file_size(folder / "a.png") / 2);
  try {
    image::readImage(folder / "a.png");
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("a.png"), std::string::npos) << error.what();
  }
}

TEST(ImageReader, NaNNamesRowAndColumn) {
  const test::TemporaryDirectory folder;
  image::Image image = ramp(8, 4, 3, image::SampleType::kFloat32);
  reinterpret_cast<float*>(image.samples.data())[(2 * 8 + 5) * 3 + 1] = std::numeric_limits<float>::quiet_NaN();
  image::writeImage(folder / "a.exr", image);
  try {
    image::readImage(folder / "a.exr");
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.parts().item, "row 2, column 5");
    EXPECT_EQ(error.parts().got, "NaN");
  }
}

TEST(ImageReader, MissingAndForeignFilesAreInputErrors) {
  const test::TemporaryDirectory folder;
  EXPECT_THROW(image::ImageReader(folder / "missing.png"), InputError);
  std::filesystem::copy_file("/proc/self/cmdline", folder / "text.png");
  EXPECT_THROW(image::ImageReader(folder / "text.png"), InputError);
}

TEST(ImageWriter, UnknownExtensionIsAnInputError) {
  const test::TemporaryDirectory folder;
  EXPECT_THROW(image::ImageWriter(folder / "a.nosuchformat", {4, 4, 3, image::SampleType::kUint8}), InputError);
}

}  // namespace
}  // namespace facezip
