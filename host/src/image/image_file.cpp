#include "image/image_file.hpp"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

#include "facezip/error.hpp"

namespace facezip::image {
namespace fs = std::filesystem;
namespace {

OIIO::TypeDesc oiioType(SampleType type) {
  switch (type) {
    case SampleType::kUint8:
      return OIIO::TypeDesc::UINT8;
    case SampleType::kUint16:
      return OIIO::TypeDesc::UINT16;
    case SampleType::kFloat32:
      break;
  }
  return OIIO::TypeDesc::FLOAT;
}

SampleType sampleType(const OIIO::TypeDesc& format) {
  switch (format.basetype) {
    case OIIO::TypeDesc::UINT8:
      return SampleType::kUint8;
    case OIIO::TypeDesc::UINT16:
      return SampleType::kUint16;
    default:
      return SampleType::kFloat32;
  }
}

/// OpenImageIO's text, without its line ends and never empty.
std::string reason(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text.empty() ? "OpenImageIO gives no reason" : text;
}

std::unique_ptr<OIIO::ImageInput> openInput(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError({path.string(), "", "an image", "no such file", ""});
  OIIO::ImageSpec config;
  // Package and capture images carry four independent channels; premultiplying by the fourth would destroy them.
  config["oiio:UnassociatedAlpha"] = 1;
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path.string(), &config);
  if (!input) {
    throw InputError({path.string(), "", "an image that OpenImageIO reads", reason(OIIO::geterror()),
                      "export it again, as PNG, TIFF or EXR"});
  }
  return input;
}

void requireFinite(const fs::path& path, const ImageShape& shape, int first_row, std::span<const std::byte> rows) {
  const std::size_t count = rows.size() / sizeof(float);
  const auto* samples = reinterpret_cast<const float*>(rows.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isfinite(samples[i])) continue;
    const std::size_t texel = i / static_cast<std::size_t>(shape.channels);
    const std::size_t width = static_cast<std::size_t>(shape.width);
    throw InputError(
        {path.string(),
         fmt::format("row {}, column {}", static_cast<std::size_t>(first_row) + texel / width, texel % width),
         "finite samples", std::isnan(samples[i]) ? "NaN" : "infinity", "repair the image"});
  }
}

}  // namespace

std::string sampleTypeName(SampleType type) {
  return type == SampleType::kUint8 ? "8-bit" : type == SampleType::kUint16 ? "16-bit" : "float";
}

struct ImageReader::Input {
  std::unique_ptr<OIIO::ImageInput> file;
  // The row of tiles that holds the last row asked for: bands need not end where tiles do.
  std::vector<std::byte> tile_rows;
  int tile_rows_begin = 0;
  int tile_rows_end = 0;
};

ImageReader::ImageReader(fs::path path) : path_(std::move(path)), input_(std::make_unique<Input>()) {
  input_->file = openInput(path_);
  const OIIO::ImageSpec& spec = input_->file->spec();
  shape_ = {spec.width, spec.height, spec.nchannels, sampleType(spec.format)};
  if (spec.depth > 1 || spec.deep) {
    throw InputError({path_.string(), "", "a flat two-dimensional image", "a volume or deep image", ""});
  }
}

ImageReader::~ImageReader() = default;
ImageReader::ImageReader(ImageReader&&) noexcept = default;
ImageReader& ImageReader::operator=(ImageReader&&) noexcept = default;

void ImageReader::readRows(int begin, int end, std::span<std::byte> out) {
  assert(0 <= begin && begin <= end && end <= shape_.height);
  assert(out.size() == static_cast<std::size_t>(end - begin) * shape_.rowBytes());
  if (begin == end) return;
  if (input_->file->spec().tile_width > 0) {
    readTiledRows(begin, end, out);
  } else {
    const int y = input_->file->spec().y;
    if (!input_->file->read_scanlines(0, 0, y + begin, y + end, 0, 0, shape_.channels, oiioType(shape_.type),
                                      out.data())) {
      throw InputError({path_.string(), fmt::format("rows {} to {}", begin, end - 1), "readable image data",
                        reason(input_->file->geterror()), "the file is truncated or damaged: export it again"});
    }
  }
  if (shape_.type == SampleType::kFloat32) requireFinite(path_, shape_, begin, out);
}

void ImageReader::readTiledRows(int begin, int end, std::span<std::byte> out) {
  const OIIO::ImageSpec& spec = input_->file->spec();
  for (int row = begin; row < end; ++row) {
    if (row < input_->tile_rows_begin || row >= input_->tile_rows_end) {
      const int tile_begin = row / spec.tile_height * spec.tile_height;
      const int tile_end = std::min(tile_begin + spec.tile_height, shape_.height);
      input_->tile_rows.resize(static_cast<std::size_t>(tile_end - tile_begin) * shape_.rowBytes());
      if (!input_->file->read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + tile_begin, spec.y + tile_end, 0, 1, 0,
                                    shape_.channels, oiioType(shape_.type), input_->tile_rows.data())) {
        throw InputError({path_.string(), fmt::format("rows {} to {}", tile_begin, tile_end - 1), "readable image data",
                          reason(input_->file->geterror()), "the file is truncated or damaged: export it again"});
      }
      input_->tile_rows_begin = tile_begin;
      input_->tile_rows_end = tile_end;
    }
    const std::size_t row_bytes = shape_.rowBytes();
    std::memcpy(out.data() + static_cast<std::size_t>(row - begin) * row_bytes,
                input_->tile_rows.data() + static_cast<std::size_t>(row - input_->tile_rows_begin) * row_bytes,
                row_bytes);
  }
}

struct ImageWriter::Output {
  std::unique_ptr<OIIO::ImageOutput> file;
};

ImageWriter::ImageWriter(fs::path path, const ImageShape& shape, const std::string& colour_space)
    : path_(std::move(path)), shape_(shape), output_(std::make_unique<Output>()) {
  output_->file = OIIO::ImageOutput::create(path_.string());
  if (!output_->file) {
    throw InputError({path_.string(), "", "an image file name that OpenImageIO can write",
                      fmt::format("extension \"{}\"", path_.extension().string()), "use .png, .tif or .exr"});
  }
  OIIO::ImageSpec spec(shape.width, shape.height, shape.channels, oiioType(shape.type));
  spec.attribute("oiio:UnassociatedAlpha", 1);
  if (!colour_space.empty()) spec.attribute("oiio:ColorSpace", colour_space);
  // EXR headers get the time of writing unless one is given: the same input would give other bytes every second.
  if (path_.extension() == ".exr") spec.attribute("DateTime", "1970:01:01 00:00:00");
  // Level 6 takes three times as long and saves a few per cent on photographic data.
  spec.attribute("png:compressionLevel", 4);
  errno = 0;
  if (!output_->file->open(path_.string(), spec)) throw OutputError(path_, reason(output_->file->geterror()));
}

ImageWriter::~ImageWriter() = default;
ImageWriter::ImageWriter(ImageWriter&&) noexcept = default;
ImageWriter& ImageWriter::operator=(ImageWriter&&) noexcept = default;

void ImageWriter::writeRows(std::span<const std::byte> rows, int row_count) {
  assert(rows.size() == static_cast<std::size_t>(row_count) * shape_.rowBytes());
  assert(next_row_ + row_count <= shape_.height);
  if (row_count == 0) return;
  if (!output_->file->write_scanlines(next_row_, next_row_ + row_count, 0, oiioType(shape_.type), rows.data())) {
    throw OutputError(path_, reason(output_->file->geterror()), "is the disk full?");
  }
  next_row_ += row_count;
}

void ImageWriter::close() {
  assert(next_row_ == shape_.height);
  if (!output_->file->close()) throw OutputError(path_, reason(output_->file->geterror()), "is the disk full?");
  output_->file.reset();
}

Image readImage(const fs::path& path) {
  ImageReader reader(path);
  Image image{reader.shape(), {}};
  image.samples.resize(static_cast<std::size_t>(image.shape.height) * image.shape.rowBytes());
  reader.readRows(0, image.shape.height, image.samples);
  return image;
}

void writeImage(const fs::path& path, const Image& image, const std::string& colour_space) {
  ImageWriter writer(path, image.shape, colour_space);
  writer.writeRows(image.samples, image.shape.height);
  writer.close();
}

}  // namespace facezip::image
