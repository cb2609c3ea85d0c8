// file_header.hpp - the numbers that stand before the blocks in a file: little-endian in both containers. What readers
// of both check with them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "blocks/block_texture.hpp"
#include "facezip/input_file.hpp"

namespace facezip::blocks {

/// Offsets count bytes. What is asked for must be there.
class FileHeader {
 public:
  FileHeader() = default;
  /// The first `count` bytes of a file. Throws InputError where it has fewer.
  FileHeader(const std::filesystem::path& path, const InputFile& file, std::size_t count);

  std::span<const std::byte> bytes() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }
  std::uint32_t word(std::size_t offset) const { return static_cast<std::uint32_t>(number(offset, 4)); }
  std::uint64_t longWord(std::size_t offset) const { return number(offset, 8); }
  std::string_view text(std::size_t offset, std::size_t size) const;

  void addWord(std::uint32_t value) { add(value, 4); }
  void addLongWord(std::uint64_t value) { add(value, 8); }
  void addText(std::string_view text);
  void addZeros(std::size_t count) { bytes_.resize(bytes_.size() + count); }
  void alignTo(std::size_t step) { addZeros((step - bytes_.size() % step) % step); }

 private:
  std::uint64_t number(std::size_t offset, std::size_t count) const;
  void add(std::uint64_t value, std::size_t count);

  std::vector<std::byte> bytes_;
};

/// A reader's checks of one file. All throw InputError that names the file and `item`.
class HeaderChecks {
 public:
  explicit HeaderChecks(const std::filesystem::path& path) : path_(path.string()) {}

  void require(bool good, const std::string& item, const std::string& expected, const std::string& got,
               const std::string& cure = "") const;
  void requireEqual(const std::string& item, std::uint64_t expected, std::uint64_t got,
                    const std::string& cure = "") const;
  int integer(const std::string& item, std::uint32_t value, int most) const;
  /// The file has all bytes of its texture and no more.
  void requireWhole(const TextureInFile& texture, const InputFile& file) const;

 private:
  std::string path_;
};

}  // namespace facezip::blocks
