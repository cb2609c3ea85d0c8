// texture_file.hpp - textures of blocks on disk, written and read a few rows of blocks at a time. The name says which
// container: .ktx2 or .dds.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "blocks/block_texture.hpp"
#include "facezip/input_file.hpp"

namespace facezip::blocks {

/// Limits of files, which readers hold to before they allocate: sides of 65536 texels in KTX2, 16384 in DDS, levels
/// down to a single texel, no byte beyond the last level.
class TextureFileReader {
 public:
  /// path  says by its extension which container; for messages
  /// Throws InputError where the file is no such texture, or is not whole.
  TextureFileReader(std::filesystem::path path, InputFile file);

  const BlockTexture& texture() const { return places_.texture; }

  /// Rows of blocks [begin, end) of a level. Several threads may read at a time.
  /// blocks  exactly (end - begin) * blockRowBytes(texture(), level) bytes
  /// Throws InputError where the file was cut short meanwhile.
  void readRows(int level, int begin, int end, std::span<std::byte> blocks) const;

  /// All of a level.
  std::vector<std::byte> readLevel(int level) const;

 private:
  std::filesystem::path path_;
  InputFile file_;
  TextureInFile places_;
};

class TextureFileWriter {
 public:
  /// Creates the file, or overwrites it. Throws InputError where the container cannot hold the texture, OutputError
  /// where the file cannot be made.
  TextureFileWriter(std::filesystem::path path, const BlockTexture& texture);
  /// Removes a file that was not closed.
  ~TextureFileWriter();
  TextureFileWriter(const TextureFileWriter&) = delete;
  TextureFileWriter& operator=(const TextureFileWriter&) = delete;

  /// The next rows of blocks of a level, from its first to its last. Levels may take turns.
  /// blocks  whole rows: a multiple of blockRowBytes(texture, level)
  /// Throws OutputError.
  void append(int level, std::span<const std::byte> blocks);

  /// Ends the file, of which all rows are there; before, it is no texture to any reader. Throws OutputError.
  void close();

 private:
  void write(std::uint64_t offset, std::span<const std::byte> bytes);

  std::filesystem::path path_;
  TextureInFile places_;
  std::vector<std::size_t> written_;  // bytes of each level
  int descriptor_ = -1;
};

}  // namespace facezip::blocks
