#include "image/image_file.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "facezip/error.hpp"
#include "image/exr_header.hpp"
#include "image/image_format.hpp"
#include "image/output_formats.hpp"

namespace facezip::image {
namespace fs = std::filesystem;
namespace {

/// Differences are squared and summed in float, in units of 1/255: far beyond this they overflow.
constexpr float kLargestSample = 1e6f;

void requireSaneFloats(const fs::path& path, const ImageShape& shape, int first_row, std::span<const std::byte> rows) {
  const std::size_t count = rows.size() / sizeof(float);
  const auto* samples = reinterpret_cast<const float*>(rows.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(samples[i]) <= kLargestSample) continue;
    const std::size_t texel = i / static_cast<std::size_t>(shape.channels);
    const std::size_t width = static_cast<std::size_t>(shape.width);
    throw InputError(
        {path.string(),
         fmt::format("row {}, column {}", static_cast<std::size_t>(first_row) + texel / width, texel % width),
         fmt::format("samples of at most {:g} either way", kLargestSample),
         std::isnan(samples[i]) ? "NaN" : fmt::format("{:g}", samples[i]), "repair the image"});
  }
}

}  // namespace

std::string sampleTypeName(SampleType type) {
  return type == SampleType::kUint8 ? "8-bit" : type == SampleType::kUint16 ? "16-bit" : "float";
}

ImageReader::ImageReader(fs::path path) : path_(std::move(path)), file_(path_, "an image") {
  input_ = openPng(path_, file_);
  if (!input_) {
    input_ = anyFormat().open(path_, file_);
  } else if (const std::vector<std::byte> exif = exifOfPng(file_); !exif.empty()) {
    requireUpright(path_, anyFormat().orientationOf(exif));
  }
  shape_ = input_->shape();
}

ImageReader::ImageReader(fs::path path, InputFile file) : path_(std::move(path)), file_(std::move(file)) {
  if (path_.extension() == ".exr") {
    requireExrHeader(file_, path_);
    input_ = anyFormat().openExr(path_, file_);
  } else {
    input_ = openPng(path_, file_);
  }
  if (!input_) {
    throw InputError(
        {path_.string(), "", "a PNG file",
         "another, or one with a palette, a transparent colour, interlacing or samples of less than 8 bits", ""});
  }
  shape_ = input_->shape();
}

std::string ImageReader::colours() const { return input_->colours(); }

ImageReader::~ImageReader() = default;
ImageReader::ImageReader(ImageReader&&) noexcept = default;
ImageReader& ImageReader::operator=(ImageReader&&) noexcept = default;

void ImageReader::readRows(int begin, int end, std::span<std::byte> out) {
  assert(0 <= begin && begin <= end && end <= shape_.height);
  assert(out.size() == static_cast<std::size_t>(end - begin) * shape_.rowBytes());
  if (begin == end) return;
  input_->readRows(begin, end, out);
  if (shape_.type == SampleType::kFloat32) requireSaneFloats(path_, shape_, begin, out);
}

ImageWriter::ImageWriter(const fs::path& path, const ImageShape& shape, const std::string& colour_space)
    : shape_(shape) {
  requireFormat(path, shape);
  output_ = createPng(path, shape, colour_space);
  if (!output_) output_ = anyFormat().create(path, shape, colour_space);
}

ImageWriter::~ImageWriter() = default;
ImageWriter::ImageWriter(ImageWriter&&) noexcept = default;
ImageWriter& ImageWriter::operator=(ImageWriter&&) noexcept = default;

void ImageWriter::writeRows(std::span<const std::byte> rows, int row_count) {
  assert(rows.size() == static_cast<std::size_t>(row_count) * shape_.rowBytes());
  assert(next_row_ + row_count <= shape_.height);
  if (row_count == 0) return;
  output_->writeRows(next_row_, row_count, rows);
  next_row_ += row_count;
}

void ImageWriter::close() {
  assert(next_row_ == shape_.height);
  output_->close();
  output_.reset();
}

Image readImage(const fs::path& path) { return readImage(ImageReader(path)); }

Image readImage(ImageReader reader) {
  Image image{reader.shape(), {}};
  image.samples.resize(static_cast<std::size_t>(image.shape.height) * image.shape.rowBytes());
  reader.readRows(0, image.shape.height, image.samples);
  return image;
}

float sampleAt(const Image& image, std::size_t index) {
  const std::byte* at = image.samples.data() + index * sampleBytes(image.shape.type);
  const auto read = [at](auto value) {
    std::memcpy(&value, at, sizeof(value));
    return static_cast<float>(value);
  };
  const float unit = unit255(image.shape.type) / 255.0f;
  switch (image.shape.type) {
    case SampleType::kUint8:
      return unit * read(std::uint8_t{});
    case SampleType::kUint16:
      return unit * read(std::uint16_t{});
    case SampleType::kFloat32:
      return unit * read(0.0f);
  }
  return 0.0f;
}

void writeImage(const fs::path& path, const Image& image, const std::string& colour_space) {
  ImageWriter writer(path, image.shape, colour_space);
  writer.writeRows(image.samples, image.shape.height);
  writer.close();
}

}  // namespace facezip::image
