#include "image/image_file.hpp"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <thread>
#include <vector>

#include "facezip/error.hpp"
#include "file_contents.hpp"
#include "image/image_format.hpp"
#include "image/output_formats.hpp"
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

/// PNG files that are not stored as they are read: OpenImageIO's part.
const std::vector<unsigned char> kPalettePng = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x03, 0x00, 0x00, 0x00, 0xc3, 0xfc, 0x8f, 0xb8, 0x00, 0x00, 0x00,
    0x06, 0x50, 0x4c, 0x54, 0x45, 0x0a, 0x14, 0x1e, 0x28, 0x32, 0x3c, 0xd5, 0x1b, 0xb4, 0xe9, 0x00, 0x00, 0x00,
    0x0b, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x64, 0x00, 0x00, 0x00, 0x05, 0x00, 0x02, 0xd1, 0x66,
    0x33, 0x78, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
const std::vector<unsigned char> kTransparentColourPng = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00, 0x00, 0x7b, 0x40, 0xe8, 0xdd, 0x00, 0x00, 0x00,
    0x06, 0x74, 0x52, 0x4e, 0x53, 0x00, 0x04, 0x00, 0x05, 0x00, 0x06, 0x74, 0x8e, 0xc6, 0x8f, 0x00, 0x00, 0x00,
    0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x64, 0x62, 0x66, 0x61, 0x65, 0x03, 0x00, 0x00, 0x3f,
    0x00, 0x16, 0x21, 0xba, 0xd4, 0x54, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

std::vector<int> samplesOf(const std::filesystem::path& file, int channels) {
  const image::Image image = image::readImage(file);
  EXPECT_EQ(image.shape, (image::ImageShape{2, 1, channels, image::SampleType::kUint8}));
  std::vector<int> samples;
  for (const std::byte sample : image.samples) samples.push_back(static_cast<int>(sample));
  return samples;
}

TEST(ImageReader, PalettesAndTransparentColoursAreDecoded) {
  const test::TemporaryDirectory folder;
  const auto write = [&](const char* name, const std::vector<unsigned char>& bytes) {
    std::ofstream stream(folder / name, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  };
  write("palette.png", kPalettePng);
  write("colour.png", kTransparentColourPng);
  EXPECT_EQ(samplesOf(folder / "palette.png", 3), (std::vector<int>{40, 50, 60, 10, 20, 30}));
  EXPECT_EQ(samplesOf(folder / "colour.png", 4), (std::vector<int>{1, 2, 3, 255, 4, 5, 6, 0}));
}

/// Two libraries handle PNG files: each must read what the other wrote.
TEST_P(ImageFile, OpenImageIoAgrees) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder / GetParam().name;
  const image::Image image = ramp(37, 21, GetParam().channels, GetParam().type);
  const auto readBy = [&](image::SampleInput& input) {
    EXPECT_EQ(input.shape(), image.shape);
    std::vector<std::byte> samples(image.samples.size());
    input.readRows(0, image.shape.height, samples);
    return samples;
  };
  for (const char* colour_space : {"", "sRGB", "linear"}) {
    image::writeImage(file, image, colour_space);
    EXPECT_EQ(readBy(*image::anyFormat().open(file, InputFile(file, "an image"))), image.samples) << colour_space;
    const auto output = image::anyFormat().create(file, image.shape, colour_space);
    output->writeRows(0, image.shape.height, image.samples);
    output->close();
    EXPECT_EQ(image::readImage(file).samples, image.samples) << colour_space;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageFile,
                         testing::Values(FileCase{"g8.png", 1, image::SampleType::kUint8},
                                         FileCase{"rgb8.png", 3, image::SampleType::kUint8},
                                         FileCase{"rgba8.png", 4, image::SampleType::kUint8},
                                         FileCase{"ga8.png", 2, image::SampleType::kUint8},
                                         FileCase{"g16.png", 1, image::SampleType::kUint16},
                                         FileCase{"rgb16.png", 3, image::SampleType::kUint16},
                                         FileCase{"rgba16.png", 4, image::SampleType::kUint16},
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
      return test::contentsOf(folder / file.name);
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

TEST(ImageReader, APngCutAnywhereIsNamedOnce) {
  const test::TemporaryDirectory folder;
  image::writeImage(folder / "a.png", ramp(64, 64, 3, image::SampleType::kUint8));
  const std::string whole = test::contentsOf(folder / "a.png");
  for (std::size_t length = 8; length < whole.size() - 16; length += 7) {
    std::ofstream(folder / "b.png", std::ios::binary) << whole.substr(0, length);
    testing::internal::CaptureStderr();  // libpng prints
    try {
      image::readImage(folder / "b.png");
      ADD_FAILURE() << length;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("truncated"), std::string::npos) << error.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << length;
  }
}

TEST(ImageReader, InksAreRefused) {
  const test::TemporaryDirectory folder;
  OIIO::ImageSpec spec(4, 4, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("tiff:ColorSpace", "CMYK");
  const std::vector<unsigned char> samples(48, 100);
  const auto out = OIIO::ImageOutput::create((folder / "a.tif").string());
  ASSERT_TRUE(out && out->open((folder / "a.tif").string(), spec));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, samples.data()) && out->close());
  try {
    image::ImageReader(folder / "a.tif");
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("CMYK"), std::string::npos) << error.what();
  }
}

// ---- files whose samples are not what they seem

void writeTagged(const std::filesystem::path& file, int orientation, int images = 1) {
  OIIO::ImageSpec spec(4, 2, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("Orientation", orientation);
  const std::vector<unsigned char> samples(24, 100);
  const auto out = OIIO::ImageOutput::create(file.string());
  const std::vector<OIIO::ImageSpec> specs(static_cast<std::size_t>(images), spec);  // EXR wants to know all
  const bool parts = images > 1 && file.extension() == ".exr";
  for (int i = 0; i < images; ++i) {
    if (i == 0 && parts) {
      ASSERT_TRUE(out && out->open(file.string(), images, specs.data()));
      ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, samples.data()));
      continue;
    }
    ASSERT_TRUE(out &&
                out->open(file.string(), spec, i == 0 ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendSubimage));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, samples.data()));
  }
  ASSERT_TRUE(out->close());
}

/// A PNG file with an EXIF block, before its samples or behind them.
void writePngWithExif(const std::filesystem::path& file, char orientation, bool behind) {
  image::writeImage(file, ramp(4, 2, 1, image::SampleType::kUint8));
  std::string png = test::contentsOf(file);
  std::string chunk = "eXIf";
  chunk += std::string("II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 18) + orientation + std::string(7, '\0');
  const auto bigEndian = [](std::size_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
    return bytes;
  };
  png.insert(png.find(behind ? "IEND" : "IDAT") - 4,
             bigEndian(chunk.size() - 4) + chunk + std::string(4, '\0'));  // its check is nobody's
  std::ofstream(file, std::ios::binary) << png;
}

template <typename Open>
std::string refusalOf(const Open& open) {
  try {
    open();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ImageReader, OrientationTagsAreRefused) {
  const test::TemporaryDirectory folder;
  const auto refusal = [&](const std::string& name) {
    return refusalOf([&] { image::ImageReader reader(folder / name); });
  };
  for (const char* name : {"a.tif", "a.jpg", "a.exr"}) {
    writeTagged(folder / name, 1);
    EXPECT_EQ(refusal(name), "") << name;
    writeTagged(folder / name, 3);
    EXPECT_THAT(refusal(name), testing::HasSubstr("orientation tag: expected 1")) << name;
    EXPECT_THAT(refusal(name), testing::HasSubstr("turned by 180 degrees")) << name;
  }
  for (const bool behind : {false, true}) {
    writePngWithExif(folder / "a.png", 1, behind);
    EXPECT_EQ(refusal("a.png"), "");
    writePngWithExif(folder / "a.png", 6, behind);
    EXPECT_THAT(refusal("a.png"), testing::HasSubstr("90 degrees clockwise")) << behind;
  }
}

TEST(ImageReader, SeveralImagesInAFileAreRefused) {
  const test::TemporaryDirectory folder;
  for (const char* name : {"a.tif", "a.exr"}) {
    writeTagged(folder / name, 1, 2);
    EXPECT_THAT(refusalOf([&] { image::ImageReader reader(folder / name); }), testing::HasSubstr("expected one image"))
        << name;
  }
}

TEST(ImageReader, ChannelsBesideTheColoursAreRefused) {
  const test::TemporaryDirectory folder;
  const auto refusal = [&](const std::vector<std::string>& names) {
    OIIO::ImageSpec spec(4, 2, static_cast<int>(names.size()), OIIO::TypeDesc::HALF);
    spec.channelnames = names;
    const std::vector<float> samples(8 * names.size(), 0.5f);
    const auto out = OIIO::ImageOutput::create("a.exr");
    EXPECT_TRUE(out->open((folder / "a.exr").string(), spec));
    EXPECT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, samples.data()) && out->close());
    return refusalOf([&] { image::ImageReader reader(folder / "a.exr"); });
  };
  for (const auto& names : std::vector<std::vector<std::string>>{{"R", "G", "B"},
                                                                 {"R", "G", "B", "A"},
                                                                 {"Y"},
                                                                 {"Z"},
                                                                 {"N.X", "N.Y", "N.Z"},
                                                                 {"diffuse.R", "diffuse.G", "diffuse.B"}}) {
    EXPECT_EQ(refusal(names), "") << names.back();
  }
  EXPECT_THAT(refusal({"R", "G", "B", "Z"}), testing::HasSubstr("R, G, B, Z"));
  EXPECT_NE(refusal({"R", "G", "B", "id"}), "");
  EXPECT_NE(refusal({"Y", "Z"}), "");
}

TEST(ImageReader, SaysWhatFilesSayOfTheirColours) {
  const test::TemporaryDirectory folder;
  for (const char* colours : {"", "sRGB", "linear"}) {
    image::writeImage(folder / "a.png", ramp(4, 2, 3, image::SampleType::kUint8), colours);
    EXPECT_EQ(image::ImageReader(folder / "a.png").colours(), colours);
  }
  OIIO::ImageSpec spec(4, 2, 3, OIIO::TypeDesc::UINT8);
  const std::vector<unsigned char> samples(24, 100);
  std::vector<std::string> said;
  for (const unsigned char content : {1, 2}) {
    const std::vector<unsigned char> profile(200, content);
    spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, 200), profile.data());
    const auto out = OIIO::ImageOutput::create("a.tif");
    ASSERT_TRUE(out->open((folder / "a.tif").string(), spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, samples.data()) && out->close());
    said.push_back(image::ImageReader(folder / "a.tif").colours());
    EXPECT_THAT(said.back(), testing::HasSubstr("ICC profile"));
  }
  EXPECT_NE(said[0], said[1]);
}

TEST(ImageReader, NoByteOfAPngIsDamagedUnnoticed) {
  const test::TemporaryDirectory folder;
  const image::Image image = ramp(21, 13, 3, image::SampleType::kUint8);
  image::writeImage(folder / "a.png", image, "sRGB");
  const std::string whole = test::contentsOf(folder / "a.png");
  int refused = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    std::ofstream(folder / "b.png", std::ios::binary) << damaged;
    try {
      const image::Image read = image::readImage(folder / "b.png");
      EXPECT_EQ(read.samples, image.samples) << "byte " << i;  // what is not needed for the samples may be damaged
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, static_cast<int>(whole.size()) / 2);
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

TEST(ImageReader, FloatsThatWouldOverflowAreInputErrors) {
  const test::TemporaryDirectory folder;
  image::Image image = ramp(8, 4, 1, image::SampleType::kFloat32);
  reinterpret_cast<float*>(image.samples.data())[9] = 1e6f;
  image::writeImage(folder / "a.exr", image);
  EXPECT_EQ(image::readImage(folder / "a.exr").samples, image.samples);
  reinterpret_cast<float*>(image.samples.data())[9] = -1.1e6f;
  image::writeImage(folder / "a.exr", image);
  EXPECT_THROW(image::readImage(folder / "a.exr"), InputError);
}

TEST(ImageReader, CroppedDataWindowsAreInputErrors) {
  const test::TemporaryDirectory folder;
  OIIO::ImageSpec spec(8, 4, 1, OIIO::TypeDesc::FLOAT);
  const std::vector<float> samples(32, 0.5f);
  for (const bool cropped : {false, true}) {
    spec.x = cropped ? 2 : 0;
    spec.full_width = cropped ? 10 : 8;
    const auto output = OIIO::ImageOutput::create("a.exr");
    ASSERT_TRUE(output->open((folder / "a.exr").string(), spec));
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, samples.data()));
    ASSERT_TRUE(output->close());
    if (cropped) {
      EXPECT_THROW(image::ImageReader reader(folder / "a.exr"), InputError);
    } else {
      EXPECT_EQ(image::readImage(folder / "a.exr").shape.width, 8);
    }
  }
}

TEST(ImageReader, MissingAndForeignFilesAreInputErrors) {
  const test::TemporaryDirectory folder;
  EXPECT_THROW(image::ImageReader(folder / "missing.png"), InputError);
  std::filesystem::copy_file("/proc/self/cmdline", folder / "text.png");
  EXPECT_THROW(image::ImageReader(folder / "text.png"), InputError);
}

TEST(ImageWriter, FormatsThatWouldLoseSamplesAreRefused) {
  const test::TemporaryDirectory folder;
  for (const char* name : {"a.png", "a.jpg", "a.bmp"}) {
    EXPECT_THROW(image::writeImage(folder / name, ramp(8, 4, 3, image::SampleType::kFloat32)), InputError) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  }
  EXPECT_THROW(image::writeImage(folder / "a.jpg", ramp(8, 4, 3, image::SampleType::kUint16)), InputError);
  EXPECT_NO_THROW(image::writeImage(folder / "a.jpg", ramp(8, 4, 3, image::SampleType::kUint8)));
  EXPECT_NO_THROW(image::writeImage(folder / "a.exr", ramp(8, 4, 3, image::SampleType::kUint8)));
}

TEST(ImageWriter, WhatPassesComesBack) {
  const test::TemporaryDirectory folder;
  int passed = 0;
  for (const char* name : {"a.png", "a.PNG", "a.tif", "a.tiff", "a.exr", "a.tga", "a.bmp"}) {
    for (const auto type : {image::SampleType::kUint8, image::SampleType::kUint16, image::SampleType::kFloat32}) {
      for (int channels = 1; channels <= 5; ++channels) {
        const image::Image written = ramp(21, 19, channels, type);
        try {
          image::requireFormat(folder / name, written.shape);
        } catch (const InputError&) {
          EXPECT_THROW(image::writeImage(folder / name, written), InputError);
          continue;
        }
        ++passed;
        image::writeImage(folder / name, written);
        const image::Image read = image::readImage(folder / name);
        EXPECT_EQ(read.shape.width, 21) << name;
        EXPECT_EQ(read.shape.height, 19) << name;
        ASSERT_EQ(read.shape.channels, channels) << name;
        if (read.shape.type == type) {
          EXPECT_EQ(read.samples, written.samples) << name << ' ' << channels;
          continue;
        }
        EXPECT_EQ(read.shape.type, image::SampleType::kFloat32) << name;  // EXR holds bytes as halves
        const auto* values = reinterpret_cast<const float*>(read.samples.data());
        for (std::size_t i = 0; i < written.samples.size(); ++i) {
          EXPECT_EQ(std::lround(255.0f * values[i]), std::to_integer<int>(written.samples[i])) << name << ' ' << i;
        }
      }
    }
  }
  EXPECT_EQ(passed, 2 * 8 + 2 * 12 + 8 + 3 + 2);
}

TEST(ImageWriter, UnknownExtensionIsAnInputError) {
  const test::TemporaryDirectory folder;
  for (const char* name : {"a.hdr", "a.jp2", "a.dpx", "a"}) {
    EXPECT_THROW(image::ImageWriter(folder / name, {4, 4, 3, image::SampleType::kUint8}), InputError) << name;
  }
  EXPECT_THROW(image::ImageWriter(folder / "a.jpg", {4, 4, 2, image::SampleType::kUint8}), InputError);
  EXPECT_THROW(image::ImageWriter(folder / "a.nosuchformat", {4, 4, 3, image::SampleType::kUint8}), InputError);
}

TEST(ImageReader, AnExrOfAPackageTakesNoMemoryByWhatItClaims) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder / "a.exr";
  image::writeImage(file, {{4, 4, 1, image::SampleType::kFloat32}, std::vector<std::byte>(64)});
  const std::string good = test::contentsOf(file);
  const auto refusal = [&](const std::string& type, std::size_t behind, const std::string& bytes) {
    std::string bad = good;
    bad.replace(bad.find(type + '\0') + type.size() + 1 + behind, bytes.size(), bytes);
    std::ofstream(file, std::ios::binary) << bad;
    try {
      image::ImageReader reader(file, InputFile(file, "an image"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("opened");
  };
  EXPECT_EQ(refusal("chlist", 0, ""), "opened");
  constexpr std::size_t kSize = 4;  // of the attribute, in front of its data
  for (const std::string& message : {refusal("chlist", 0, "\xff\xff\xff\x7f"),                  // larger than the file
                                     refusal("box2i", kSize + 8, "\xff\xff\xff\x7f"),           // 2^31 columns
                                     refusal("compression", 12 + kSize, std::string(1, 9))}) {  // DWAB
    EXPECT_THAT(message, testing::HasSubstr("any compression but DWA"));
  }
  std::string several = good;
  several[5] = '\x10';
  std::ofstream(file, std::ios::binary) << several;
  EXPECT_THROW(image::ImageReader(file, InputFile(file, "an image")), InputError);
}

}  // namespace
}  // namespace facezip
