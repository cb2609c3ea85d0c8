// oiio_file.cpp - images of every format that OpenImageIO knows. The one file of the library that sees OpenImageIO.
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/tiffutils.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

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

/// Behind the first image: pages of a TIFF, parts of an EXR, frames. A Photoshop file's first image is all of its
/// layers.
void requireOneImage(const fs::path& path, OIIO::ImageInput& input) {
  if (std::string_view(input.format_name()) == "psd") return;
  if (input.seek_subimage(1, 0)) {
    throw InputError(
        {path.string(), "", "one image", "several (pages, parts or frames)", "export the one that is meant, alone"});
  }
  static_cast<void>(input.geterror());  // that there is no other
  if (!input.seek_subimage(0, 0)) {
    throw InputError({path.string(), "", "an image that OpenImageIO reads", reason(input.geterror()), ""});
  }
}

/// A channel's name without its layer's.
std::string plainChannel(const std::string& name) {
  std::string plain = name.substr(name.rfind('.') + 1);
  std::ranges::transform(plain, plain.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return plain;
}

/// Renderers put depth, identifiers and the like beside colours: as a fourth channel they would pass for alpha.
void requireNoFurtherChannels(const fs::path& path, const OIIO::ImageSpec& spec) {
  std::vector<std::string> names;
  for (const std::string& name : spec.channelnames) names.push_back(plainChannel(name));
  const auto has = [&names](const char* name) { return std::ranges::find(names, name) != names.end(); };
  const bool colours = has("R") && has("G") && has("B");
  const auto isFurther = [&](const std::string& name) {
    if (colours) return name != "R" && name != "G" && name != "B" && name != "A" && name != "ALPHA";
    // Luminance with chroma at half the size, which OpenImageIO gives as it is; depth beside anything but X and Y.
    return name == "RY" || name == "BY" || (names.size() > 1 && !has("X") && (name == "Z" || name == "DEPTH"));
  };
  if (std::ranges::none_of(names, isFurther)) return;
  throw InputError({path.string(), "channels", "R, G, B and perhaps A, or channels of one kind",
                    fmt::format("{}", fmt::join(spec.channelnames, ", ")), "export the channels of the map alone"});
}

std::string coloursOf(const OIIO::ImageSpec& spec) {
  const OIIO::ParamValue* profile = spec.find_attribute("ICCProfile");
  if (profile != nullptr) {
    return profileName(
        std::string(spec.get_string_attribute("ICCProfile:profile_description", "without a name")),
        std::span(static_cast<const std::byte*>(profile->data()), static_cast<std::size_t>(profile->datasize())));
  }
  const std::string name(spec.get_string_attribute("oiio:ColorSpace"));
  return name == "Linear" ? "linear" : name;
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
    requireUpright(path_, spec.get_int_attribute("Orientation", 1));
    requireNoFurtherChannels(path_, spec);
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
  std::string colours() const override { return coloursOf(file_->spec()); }

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
    std::unique_ptr<OIIO::ImageInput> input = openInput(path, openName(file));
    requireOneImage(path, *input);
    return std::make_unique<OiioInput>(path, file, std::move(input));
  }

  int orientationOf(std::span<const std::byte> exif) override {
    OIIO::ImageSpec spec;
    const std::string_view bytes(reinterpret_cast<const char*>(exif.data()), exif.size());
    return OIIO::decode_exif(bytes, spec) ? spec.get_int_attribute("Orientation", 1) : 1;
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
