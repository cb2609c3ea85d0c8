// package_textures.hpp - the neutral and difference textures of a package as samples, whatever they are stored as:
// images, or blocks in KTX2 files.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "blocks/block_decoder.hpp"
#include "blocks/texture_file.hpp"
#include "facezip/package.hpp"
#include "image/image_file.hpp"
#include "io/folder.hpp"

namespace facezip::package {

/// A texture of a map, and what it is read as.
struct StoredTexture {
  std::string file;                   ///< relative to the package
  std::optional<BlockFormat> format;  ///< of its blocks; none: an image
  image::ImageShape shape;            ///< of the samples that TextureReader gives
};

/// Blocks that decode to whole codes are read as 8 bits. All others (ASTC, BC4, BC5) decode to values between them and
/// are read as 16 bits, 257 to a code.
StoredTexture neutralTexture(const PackageMap& map);
/// The difference textures of a map are read as one type: 16 bits where one of them needs it.
StoredTexture differenceTexture(const PackageMap& map, int difference);

/// Whether one of a map's textures is in blocks.
bool hasBlocks(const PackageMap& map);

/// Bits of the codes that differenceTexture() is read as, 8 or 16.
int readBits(const PackageMap& map);

/// Bytes that a renderer keeps of it: level 0.
std::uint64_t bytesInMemory(const StoredTexture& texture);

/// Opens the texture and checks that it is whole and what `texture` says. Returns its bytes. Throws InputError.
std::uint64_t checkTexture(const io::Folder& folder, const StoredTexture& texture);

/// Opens a texture in blocks. Throws InputError: not what `texture` says, not whole.
blocks::TextureFileReader openBlocks(const io::Folder& folder, const StoredTexture& texture);

/// Reads rows of one texture.
class TextureReader {
 public:
  /// Throws InputError that names the file when it is missing, unreadable or not what `texture` says.
  TextureReader(const io::Folder& folder, const StoredTexture& texture);

  const image::ImageShape& shape() const { return shape_; }

  /// Rows [begin, end): exactly (end - begin) * shape().rowBytes() bytes. Images want rows in rising order. Throws
  /// InputError.
  void readRows(int begin, int end, std::span<std::byte> out);

 private:
  void readBlocks(int begin, int end, std::span<std::byte> out);

  image::ImageShape shape_;
  std::unique_ptr<image::ImageReader> image_;  // one of the two
  std::unique_ptr<blocks::TextureFileReader> blocks_;
  std::unique_ptr<blocks::BlockDecoder> decoder_;
  std::vector<std::byte> block_rows_;
  std::vector<float> texels_;
};

/// All of a texture, for small ones and pictures. Throws InputError.
image::Image readTexture(const io::Folder& folder, const StoredTexture& texture);

}  // namespace facezip::package
