// image_format.hpp - what image_file.hpp reads and writes through: PNG files by libspng, all others by OpenImageIO.
//
// PNG is what packages and frames are made of, and Debian's OpenImageIO brings 250 libraries: loading them takes longer
// than blending a frame. So a program may leave OpenImageIO to a module that is loaded when a file asks for it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "image/image_file.hpp"

namespace facezip::image {

/// One image, opened for reading; ImageReader says what its functions do.
class SampleInput {
 public:
  virtual ~SampleInput() = default;
  virtual ImageShape shape() const = 0;
  virtual void readRows(int begin, int end, std::span<std::byte> out) = 0;
  /// What the file says of its colours: ImageReader::colours().
  virtual std::string colours() const = 0;
};

/// One image, opened for writing; ImageWriter says what its functions do.
class SampleOutput {
 public:
  virtual ~SampleOutput() = default;
  virtual void writeRows(int first_row, int row_count, std::span<const std::byte> rows) = 0;
  virtual void close() = 0;
};

/// Reads a PNG file whose samples are stored as they are: 8 or 16 bits, neither palette nor transparent colour, not
/// interlaced. Null for every other file, which is left to anyFormat().
/// path  for messages
/// file  must outlive what is returned
std::unique_ptr<SampleInput> openPng(const std::filesystem::path& path, const InputFile& file);

/// The eXIf chunk of a PNG file, which may stand behind the samples too; empty where there is none. Nothing of it is
/// checked.
std::vector<std::byte> exifOfPng(const InputFile& file);

/// "ICC profile NAME", with what tells it from others of that name.
std::string profileName(const std::string& name, std::span<const std::byte> profile);

/// Throws InputError for an orientation tag (EXIF, TIFF) that asks for anything but the rows as they are stored.
void requireUpright(const std::filesystem::path& path, int orientation);

/// Creates a PNG file. Null for names that do not end in .png.
/// Throws OutputError.
std::unique_ptr<SampleOutput> createPng(const std::filesystem::path& path, const ImageShape& shape,
                                        const std::string& colour_space);

/// Every format that OpenImageIO knows.
class AnyFormat {
 public:
  virtual ~AnyFormat() = default;
  /// path  says by its extension which reader is tried first
  /// file  is read; must outlive what is returned
  /// Throws InputError.
  virtual std::unique_ptr<SampleInput> open(const std::filesystem::path& path, const InputFile& file) = 0;
  /// The orientation that an EXIF block asks for, 1 to 8; 1 where it says nothing.
  virtual int orientationOf(std::span<const std::byte> exif) = 0;
  /// An EXR file as packages hold them, and no other: one flat image in rows. path  for messages. Throws InputError.
  virtual std::unique_ptr<SampleInput> openExr(const std::filesystem::path& path, const InputFile& file) = 0;
  /// path, shape  that requireFormat() lets pass. Throws OutputError.
  virtual std::unique_ptr<SampleOutput> create(const std::filesystem::path& path, const ImageShape& shape,
                                               const std::string& colour_space) = 0;
};

/// OpenImageIO, as this program was linked: directly (linked_formats.cpp), or loaded when first asked for
/// (loaded_formats.cpp). Throws Error when it cannot be loaded.
AnyFormat& anyFormat();

/// What the module exports; the library facezip holds it itself.
extern "C" __attribute__((visibility("default"))) AnyFormat& facezipOpenImageIo();
inline constexpr const char* kOpenImageIoEntry = "facezipOpenImageIo";

}  // namespace facezip::image
