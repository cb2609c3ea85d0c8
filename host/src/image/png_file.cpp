#include <fmt/format.h>
#include <spng.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include "facezip/error.hpp"
#include "image/image_format.hpp"

namespace facezip::image {
namespace fs = std::filesystem;
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

struct FreeContext {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Context = std::unique_ptr<spng_ctx, FreeContext>;

/// The bytes of an open file from its first to its last. No stdio: that would take a second descriptor of every
/// texture.
class Source {
 public:
  explicit Source(const InputFile& file) : descriptor_(file.descriptor()) {}

  void rewind() { offset_ = filled_ = next_ = 0; }

  /// 0, or an error of libspng's.
  int read(std::span<std::byte> out) {
    while (!out.empty()) {
      if (next_ == filled_) {
        if (const int error = fill()) return error;
      }
      const std::size_t count = std::min(out.size(), filled_ - next_);
      std::memcpy(out.data(), buffer_.data() + next_, count);
      next_ += count;
      out = out.subspan(count);
    }
    return 0;
  }

 private:
  int fill() {
    ssize_t got = 0;
    do {
      got = ::pread(descriptor_, buffer_.data(), buffer_.size(), offset_);
    } while (got < 0 && errno == EINTR);
    if (got <= 0) return got < 0 ? SPNG_IO_ERROR : SPNG_IO_EOF;
    offset_ += got;
    filled_ = static_cast<std::size_t>(got);
    next_ = 0;
    return 0;
  }

  int descriptor_;
  off_t offset_ = 0;
  std::size_t filled_ = 0;
  std::size_t next_ = 0;
  std::array<std::byte, 16384> buffer_;
};

int readSource(spng_ctx*, void* source, void* out, std::size_t bytes) {
  return static_cast<Source*>(source)->read({static_cast<std::byte*>(out), bytes});
}

bool isPng(Source& source) {
  constexpr std::array<unsigned char, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  std::array<unsigned char, 8> begin = {};
  const bool is_png = source.read(std::as_writable_bytes(std::span(begin))) == 0 && begin == kSignature;
  source.rewind();
  return is_png;
}

/// True for errors that no reader of PNG gets past. Others may be libspng's own limits.
bool isDamage(int error) {
  switch (error) {
    case SPNG_IO_ERROR:
    case SPNG_IO_EOF:
    case SPNG_ECHUNK_CRC:
    case SPNG_EIDAT_TOO_SHORT:
    case SPNG_EIDAT_STREAM:
      return true;
    default:
      return false;
  }
}

int channelsOf(std::uint8_t colour_type) {
  switch (colour_type) {
    case SPNG_COLOR_TYPE_GRAYSCALE:
      return 1;
    case SPNG_COLOR_TYPE_GRAYSCALE_ALPHA:
      return 2;
    case SPNG_COLOR_TYPE_TRUECOLOR:
      return 3;
    case SPNG_COLOR_TYPE_TRUECOLOR_ALPHA:
      return 4;
    default:
      return 0;  // a palette
  }
}

std::uint8_t colourTypeOf(int channels) {
  constexpr std::uint8_t kTypes[] = {SPNG_COLOR_TYPE_GRAYSCALE, SPNG_COLOR_TYPE_GRAYSCALE_ALPHA,
                                     SPNG_COLOR_TYPE_TRUECOLOR, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA};
  return kTypes[channels - 1];
}

/// Beyond what a map may have, and what texts and profiles beside the samples need: a few bytes of these may claim, and
/// unpack to, gigabytes.
constexpr std::uint32_t kMostTexels = 1 << 16;
constexpr std::size_t kMostChunkBytes = std::size_t{16} << 20;
constexpr std::size_t kMostAllChunkBytes = std::size_t{64} << 20;

/// What one of the chunks says of which libspng keeps one: others would be in conflict with it.
std::string coloursOf(spng_ctx* context) {
  spng_iccp profile;
  if (spng_get_iccp(context, &profile) == 0) {
    return profileName(profile.profile_name, std::as_bytes(std::span(profile.profile, profile.profile_len)));
  }
  std::uint8_t intent = 0;
  double gamma = 0.0;
  if (spng_get_srgb(context, &intent) == 0) return "sRGB";
  if (spng_get_gama(context, &gamma) != 0) return "";
  constexpr double kNearly = 0.001;  // files hold five digits, and writers round 1 / 2.2 either way
  if (std::abs(gamma - 1.0) < kNearly) return "linear";
  return std::abs(gamma - 1.0 / 2.2) < kNearly ? "sRGB" : fmt::format("gamma {:.3g}", gamma);
}

class PngInput : public SampleInput {
 public:
  /// file  must outlive this object
  PngInput(fs::path path, const InputFile& file) : path_(std::move(path)), source_(file) {}

  /// Reads all that stands before the samples. False where this is not a file for openPng(). Throws InputError for
  /// a damaged one: OpenImageIO would not read it either, and libpng prints a line of its own.
  bool open() {
    context_.reset(spng_ctx_new(0));
    source_.rewind();
    spng_ihdr header;
    spng_trns transparent;
    if (!context_ || !isPng(source_) || spng_set_png_stream(context_.get(), readSource, &source_) != 0 ||
        // What is not needed for the samples may be damaged.
        spng_set_crc_action(context_.get(), SPNG_CRC_ERROR, SPNG_CRC_DISCARD) != 0 ||
        spng_set_image_limits(context_.get(), kMostTexels, kMostTexels) != 0 ||
        spng_set_chunk_limits(context_.get(), kMostChunkBytes, kMostAllChunkBytes) != 0 ||
        !succeeds(spng_get_ihdr(context_.get(), &header)) || succeeds(spng_get_trns(context_.get(), &transparent)) ||
        (header.bit_depth != 8 && header.bit_depth != 16) || header.interlace_method != SPNG_INTERLACE_NONE) {
      return false;
    }
    shape_ = {static_cast<int>(header.width), static_cast<int>(header.height), channelsOf(header.color_type),
              header.bit_depth == 16 ? SampleType::kUint16 : SampleType::kUint8};
    colours_ = coloursOf(context_.get());
    next_row_ = 0;
    decoding_ = false;
    return shape_.channels > 0;
  }

  ImageShape shape() const override { return shape_; }
  std::string colours() const override { return colours_; }

  void readRows(int begin, int end, std::span<std::byte> out) override {
    if (begin < next_row_ && !open()) damaged(begin, end, "the file changed");
    if (!decoding_) startDecoding();
    unused_row_.resize(begin > next_row_ ? shape_.rowBytes() : 0);
    while (next_row_ < begin) readRow(begin, end, unused_row_);
    for (std::size_t offset = 0; next_row_ < end; offset += shape_.rowBytes()) {
      readRow(begin, end, out.subspan(offset, shape_.rowBytes()));
    }
  }

 private:
  /// Takes memory by the size that the file claims: not before somebody who has seen it asks for rows.
  void startDecoding() {
    const int error = spng_decode_image(context_.get(), nullptr, 0, SPNG_FMT_PNG, SPNG_DECODE_PROGRESSIVE);
    if (error != 0) damaged("", spng_strerror(error));
    decoding_ = true;
  }

  bool succeeds(int error) const {
    if (isDamage(error)) damaged("", spng_strerror(error));
    return error == 0;
  }

  void readRow(int begin, int end, std::span<std::byte> row) {
    const int error = spng_decode_row(context_.get(), row.data(), row.size());
    if (error != 0 && error != SPNG_EOI) damaged(begin, end, spng_strerror(error));  // EOI comes with the last row
    ++next_row_;
  }

  [[noreturn]] void damaged(int begin, int end, const char* reason) {
    next_row_ = shape_.height;  // the next call opens the file again
    damaged(fmt::format("rows {} to {}", begin, end - 1), reason);
  }

  [[noreturn]] void damaged(const std::string& item, const char* reason) const {
    throw InputError(
        {path_.string(), item, "readable image data", reason, "the file is truncated or damaged: replace it"});
  }

  fs::path path_;
  Source source_;
  Context context_;  // reads source_: goes before it
  ImageShape shape_;
  std::string colours_;
  bool decoding_ = false;
  int next_row_ = 0;
  std::vector<std::byte> unused_row_;
};

class PngOutput : public SampleOutput {
 public:
  PngOutput(fs::path path, const ImageShape& shape, const std::string& colour_space) : path_(std::move(path)) {
    file_.reset(std::fopen(path_.c_str(), "wb"));
    if (!file_) throw OutputError(path_, std::strerror(errno));
    context_.reset(spng_ctx_new(SPNG_CTX_ENCODER));
    row_bytes_ = shape.rowBytes();
    spng_ihdr header{static_cast<std::uint32_t>(shape.width),
                     static_cast<std::uint32_t>(shape.height),
                     static_cast<std::uint8_t>(8 * sampleBytes(shape.type)),
                     colourTypeOf(shape.channels),
                     0,
                     SPNG_FILTER_NONE,
                     SPNG_INTERLACE_NONE};
    check(spng_set_png_file(context_.get(), file_.get()));
    check(spng_set_ihdr(context_.get(), &header));
    // Of photographic data, run lengths of differences from the mean of the texels to the left and above take a third
    // of the default's time and fewer bytes.
    check(spng_set_option(context_.get(), SPNG_IMG_COMPRESSION_STRATEGY, Z_RLE));
    check(spng_set_option(context_.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_AVG));
    setColourSpace(colour_space);
    check(spng_encode_image(context_.get(), nullptr, 0, SPNG_FMT_PNG, SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE));
  }

  void writeRows(int, int row_count, std::span<const std::byte> rows) override {
    for (int row = 0; row < row_count; ++row) {
      const int error =
          spng_encode_row(context_.get(), rows.data() + static_cast<std::size_t>(row) * row_bytes_, row_bytes_);
      if (error != SPNG_EOI) check(error);  // EOI comes with the last row
    }
  }

  void close() override {
    context_.reset();
    if (std::fclose(file_.release()) != 0) throw OutputError(path_, std::strerror(errno), "is the disk full?");
  }

 private:
  void setColourSpace(const std::string& name) {
    if (name == "linear") check(spng_set_gama(context_.get(), 1.0));
    if (name != "sRGB") return;
    // With what readers that do not know the sRGB chunk go by, as the PNG specification recommends.
    spng_chrm primaries{0.3127, 0.329, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06};
    check(spng_set_srgb(context_.get(), /* perceptual */ 0));
    check(spng_set_gama(context_.get(), 0.45455));
    check(spng_set_chrm(context_.get(), &primaries));
  }

  void check(int error) const {
    if (error != 0) throw OutputError(path_, spng_strerror(error), "is the disk full?");
  }

  fs::path path_;
  File file_;
  Context context_;  // goes before the file it writes
  std::size_t row_bytes_ = 0;
};

}  // namespace

std::unique_ptr<SampleInput> openPng(const fs::path& path, const InputFile& file) {
  auto input = std::make_unique<PngInput>(path, file);
  return input->open() ? std::move(input) : nullptr;
}

std::vector<std::byte> exifOfPng(const InputFile& file) {
  constexpr std::size_t kSignatureBytes = 8, kHeadBytes = 8, kCheckBytes = 4;
  const auto read = [&file](std::span<std::byte> out, std::size_t at) {
    ssize_t got = 0;
    do {
      got = ::pread(file.descriptor(), out.data(), out.size(), static_cast<off_t>(at));
    } while (got < 0 && errno == EINTR);
    return got == static_cast<ssize_t>(out.size());
  };
  std::array<std::byte, kHeadBytes> head{};
  for (std::size_t at = kSignatureBytes; read(head, at);) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | std::to_integer<std::size_t>(head[i]);
    const std::string_view type(reinterpret_cast<const char*>(head.data()) + 4, 4);
    if (type == "IEND") break;
    if (type == "eXIf") {
      std::vector<std::byte> exif(std::min(length, kMostChunkBytes));
      if (read(exif, at + kHeadBytes)) return exif;
    }
    at += kHeadBytes + length + kCheckBytes;
  }
  return {};
}

std::unique_ptr<SampleOutput> createPng(const fs::path& path, const ImageShape& shape,
                                        const std::string& colour_space) {
  if (path.extension() != ".png") return nullptr;
  return std::make_unique<PngOutput>(path, shape, colour_space);
}

}  // namespace facezip::image
