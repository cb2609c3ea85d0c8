// image_file.hpp - images on disk, read and written in bands of rows.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "facezip/input_file.hpp"
#include "facezip/sample_type.hpp"

namespace facezip::image {

using facezip::SampleType;

constexpr std::size_t sampleBytes(SampleType type) {
  return type == SampleType::kUint8 ? 1 : type == SampleType::kUint16 ? 2 : 4;
}
/// "8-bit", "16-bit" or "float", for messages and package.json.
std::string sampleTypeName(SampleType type);

/// Factor from a stored sample to facezip's working unit, 1/255 of full scale (full scale of a float image is 1).
constexpr float unit255(SampleType type) {
  return type == SampleType::kUint8 ? 1.0f : type == SampleType::kUint16 ? 255.0f / 65535.0f : 255.0f;
}

class SampleInput;
class SampleOutput;

struct ImageShape {
  int width = 0;
  int height = 0;
  int channels = 0;
  SampleType type = SampleType::kUint8;

  std::size_t rowBytes() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(channels) * sampleBytes(type);
  }
  bool operator==(const ImageShape&) const = default;
};

/// Reads an image from top to bottom. Samples are raw: no colour conversion, no premultiplication by alpha.
class ImageReader {
 public:
  /// Opens `path`. Throws InputError if it is missing, no regular file, unreadable or of a kind that OpenImageIO does
  /// not know; and if its samples are not what they seem: an orientation tag that turns them, further images in the
  /// file, channels beside the colours. The file stays open: what is renamed over it later is not read.
  explicit ImageReader(std::filesystem::path path);
  /// Reads an image of a package, by the reader that its name asks for and no other: PNG whose samples are stored as
  /// they are, or EXR. It may come from anywhere, and claim any size: memory is not taken by it before rows are read.
  /// path  for messages. Throws InputError.
  ImageReader(std::filesystem::path path, InputFile file);
  ~ImageReader();
  ImageReader(ImageReader&&) noexcept;
  ImageReader& operator=(ImageReader&&) noexcept;

  const ImageShape& shape() const { return shape_; }
  const std::filesystem::path& path() const { return path_; }
  const InputFile& file() const { return file_; }
  /// What the file says of its colours: "sRGB", "linear", a gamma, an ICC profile by name; "" where it says nothing.
  /// Samples are never converted by it.
  std::string colours() const;

  /// Reads rows [begin, end) into `out` (row-major, channels interleaved, exactly (end - begin) * rowBytes()).
  /// Bands in rising order are read once; going back re-reads compressed files from their start.
  /// Throws InputError on a truncated or corrupt file, and on NaN, infinity or samples beyond 1e6 in float images.
  void readRows(int begin, int end, std::span<std::byte> out);

 private:
  std::filesystem::path path_;
  InputFile file_;
  ImageShape shape_;
  std::unique_ptr<SampleInput> input_;  // reads file_: the first to go
};

/// Writes an image from top to bottom.
class ImageWriter {
 public:
  /// Creates `path`; the extension decides the format. Throws InputError as requireFormat() does (output_formats.hpp),
  /// OutputError if the file cannot be created.
  /// `colour_space` is recorded where the format can ("sRGB", "linear"; empty: not recorded).
  ImageWriter(const std::filesystem::path& path, const ImageShape& shape, const std::string& colour_space = "");
  ~ImageWriter();
  ImageWriter(ImageWriter&&) noexcept;
  ImageWriter& operator=(ImageWriter&&) noexcept;

  /// Writes the next `row_count` rows. Throws OutputError (a full disk, say).
  void writeRows(std::span<const std::byte> rows, int row_count);

  /// Finishes the file; must be called, since only then is a full disk noticed. Throws OutputError.
  void close();

 private:
  ImageShape shape_;
  int next_row_ = 0;
  std::unique_ptr<SampleOutput> output_;
};

/// A whole image in memory, for small ones (coverage masks, weight atlases, contact sheets).
struct Image {
  ImageShape shape;
  std::vector<std::byte> samples;  ///< row-major, channels interleaved
};
Image readImage(const std::filesystem::path& path);
Image readImage(ImageReader reader);
void writeImage(const std::filesystem::path& path, const Image& image, const std::string& colour_space = "");
/// One sample, 1 at full scale. index  into the samples, not the bytes
float sampleAt(const Image& image, std::size_t index);

}  // namespace facezip::image
