// oiio_file.cpp - images of every format that OpenImageIO knows. The one file of the library that sees OpenImageIO.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <utility>

#include "facezip/error.hpp"
#include "image/image_format.hpp"

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

/// OpenImageIO's text in one line that is never empty. It may hold the same words again, in longer sentences.
std::string reason(const std::string& text) {
  std::string line;
  std::istringstream lines(text);
  for (std::string next; std::getline(lines, next);) {
    if (next.find(line) != std::string::npos) line.clear();
    if (line.find(next) == std::string::npos) line += (line.empty() ? "" : "; ") + next;
  }
  return line.empty() ? "OpenImageIO gives no reason" : line;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

/// The file by its descriptor, so that the one that was checked is read, now and when a reader opens it once more.
std::unique_ptr<OIIO::ImageInput> openInput(const fs::path& path, const std::string& open_name) {
  OIIO::ImageSpec config;
  // Package and capture images carry four independent channels; premultiplying by the fourth would destroy them.
  config["oiio:UnassociatedAlpha"] = 1;
  // As OpenImageIO does with names: the reader of the extension first, since some formats cannot be told by what they
  // hold, then whichever knows the content.
  const std::string extension = path.extension().string();
  const auto refuse = [&](const std::string& text) {
    throw InputError({path.string(), "", "an image that OpenImageIO reads",
                      replaced(reason(text), open_name, path.filename().string()),
                      "export it again, as PNG, TIFF or EXR"});
  };
  std::unique_ptr<OIIO::ImageInput> input;
  if (extension.size() > 1) input = OIIO::ImageInput::create(extension.substr(1), /*do_open=*/false);
  if (input && input->valid_file(open_name)) {
    OIIO::ImageSpec ignored;
    if (!input->open(open_name, ignored, config)) refuse(input->geterror());
    return input;
  }
  static_cast<void>(OIIO::geterror());  // of an extension that names no format
  input = OIIO::ImageInput::open(open_name, &config);
  if (!input) refuse(OIIO::geterror());
  return input;
}

std::string openName(const InputFile& file) { return fmt::format("/proc/self/fd/{}", file.descriptor()); }

/// By the reader of EXR alone: others might take the file for what it is not.
std::unique_ptr<OIIO::ImageInput> openExrInput(const fs::path& path, const std::string& open_name) {
  const auto fail = [&](const std::string& got) {
    throw InputError({path.string(), "", "an EXR file", replaced(got, open_name, path.filename().string()), ""});
  };
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create("openexr", /*do_open=*/false);
  if (!input) fail(reason(OIIO::geterror()));
  OIIO::ImageSpec spec;
  if (!input->open(open_name, spec)) fail(reason(input->geterror()));
  if (spec.tile_width > 0) fail("tiles, not rows");
  if (input->seek_subimage(1, 0)) fail("several images in one file");
  static_cast<void>(input->geterror());  // that there is no other
  if (!input->seek_subimage(0, 0)) fail(reason(input->geterror()));
  return input;
}

class OiioInput : public SampleInput {
 public:
  OiioInput(const fs::path& path, const InputFile& file, std::unique_ptr<OIIO::ImageInput> opened)
      : path_(path), open_name_(openName(file)), file_(std::move(opened)) {
    const OIIO::ImageSpec& spec = file_->spec();
    shape_ = {spec.width, spec.height, spec.nchannels, sampleType(spec.format)};
    if (spec.depth > 1 || spec.deep) {
      throw InputError({path_.string(), "", "a flat two-dimensional image", "a volume or deep image", ""});
    }
    constexpr int kSeparated = 5;  // which OpenImageIO converts to RGB
    if (spec.get_int_attribute("tiff:PhotometricInterpretation") == kSeparated) {
      throw InputError(
          {path_.string(), "", "samples that need no conversion of colours", "inks (CMYK)", "export it again, as RGB"});
    }
    // A cropped image would lie beside its neutral.
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
        spec.height != spec.full_height) {
      throw InputError({path_.string(), "data window",
                        fmt::format("the whole display window, {} x {} from ({}, {})", spec.full_width,
                                    spec.full_height, spec.full_x, spec.full_y),
                        fmt::format("{} x {} from ({}, {})", spec.width, spec.height, spec.x, spec.y),
                        "export it without cropping"});
    }
  }

  ImageShape shape() const override { return shape_; }

  void readRows(int begin, int end, std::span<std::byte> out) override {
    const OIIO::ImageSpec& spec = file_->spec();
    if (spec.tile_width > 0) {
      readTiledRows(begin, end, out);
    } else if (!file_->read_scanlines(0, 0, spec.y + begin, spec.y + end, 0, 0, shape_.channels, oiioType(shape_.type),
                                      out.data())) {
      damaged(begin, end);
    }
  }

 private:
  void readTiledRows(int begin, int end, std::span<std::byte> out) {
    const OIIO::ImageSpec& spec = file_->spec();
    for (int row = begin; row < end; ++row) {
      if (row < tile_rows_begin_ || row >= tile_rows_end_) {
        const int tile_begin = row / spec.tile_height * spec.tile_height;
        const int tile_end = std::min(tile_begin + spec.tile_height, shape_.height);
        tile_rows_.resize(static_cast<std::size_t>(tile_end - tile_begin) * shape_.rowBytes());
        if (!file_->read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + tile_begin, spec.y + tile_end, 0, 1, 0,
                               shape_.channels, oiioType(shape_.type), tile_rows_.data())) {
          damaged(tile_begin, tile_end);
        }
        tile_rows_begin_ = tile_begin;
        tile_rows_end_ = tile_end;
      }
      const std::size_t row_bytes = shape_.rowBytes();
      std::memcpy(out.data() + static_cast<std::size_t>(row - begin) * row_bytes,
                  tile_rows_.data() + static_cast<std::size_t>(row - tile_rows_begin_) * row_bytes, row_bytes);
    }
  }

  [[noreturn]] void damaged(int begin, int end) const {
    throw InputError({path_.string(), fmt::format("rows {} to {}", begin, end - 1), "readable image data",
                      replaced(reason(file_->geterror()), open_name_, path_.filename().string()),
                      "the file is truncated or damaged: replace it"});
  }

  fs::path path_;
  std::string open_name_;
  std::unique_ptr<OIIO::ImageInput> file_;
  ImageShape shape_;
  // The row of tiles that holds the last row asked for: bands need not end where tiles do.
  std::vector<std::byte> tile_rows_;
  int tile_rows_begin_ = 0;
  int tile_rows_end_ = 0;
};

class OiioOutput : public SampleOutput {
 public:
  OiioOutput(const fs::path& path, const ImageShape& shape, const std::string& colour_space)
      : path_(path), type_(oiioType(shape.type)), file_(OIIO::ImageOutput::create(path.string())) {
    if (!file_) throw OutputError(path_, reason(OIIO::geterror()), "use .png");
    OIIO::ImageSpec spec(shape.width, shape.height, shape.channels, type_);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (!colour_space.empty()) spec.attribute("oiio:ColorSpace", colour_space);
    // EXR headers get the time of writing unless one is given: the same input would give other bytes every second.
    if (path_.extension() == ".exr") spec.attribute("DateTime", "1970:01:01 00:00:00");
    errno = 0;
    if (!file_->open(path_.string(), spec)) throw OutputError(path_, reason(file_->geterror()));
  }

  void writeRows(int first_row, int row_count, std::span<const std::byte> rows) override {
    if (!file_->write_scanlines(first_row, first_row + row_count, 0, type_, rows.data())) fail();
  }

  void close() override {
    if (!file_->close()) fail();
  }

 private:
  [[noreturn]] void fail() const { throw OutputError(path_, reason(file_->geterror()), "is the disk full?"); }

  fs::path path_;
  OIIO::TypeDesc type_;
  std::unique_ptr<OIIO::ImageOutput> file_;
};

class OpenImageIo : public AnyFormat {
 public:
  std::unique_ptr<SampleInput> open(const fs::path& path, const InputFile& file) override {
    return std::make_unique<OiioInput>(path, file, openInput(path, openName(file)));
  }

  std::unique_ptr<SampleInput> openExr(const fs::path& path, const InputFile& file) override {
    return std::make_unique<OiioInput>(path, file, openExrInput(path, openName(file)));
  }

  std::unique_ptr<SampleOutput> create(const fs::path& path, const ImageShape& shape,
                                       const std::string& colour_space) override {
    return std::make_unique<OiioOutput>(path, shape, colour_space);
  }
};

}  // namespace

extern "C" AnyFormat& facezipOpenImageIo() {
  static OpenImageIo formats;
  return formats;
}

}  // namespace facezip::image
