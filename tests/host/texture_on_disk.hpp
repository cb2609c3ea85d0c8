// texture_on_disk.hpp - textures of blocks in files, for the tests of their containers.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <new>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "blocks/texture_file.hpp"
#include "facezip/error.hpp"

namespace facezip::test {

using BlockLevels = std::vector<std::vector<std::byte>>;

inline BlockLevels anyBlocks(const blocks::BlockTexture& texture, unsigned seed = 1) {
  std::mt19937 random(seed);
  BlockLevels levels;
  for (int level = 0; level < texture.levels; ++level) {
    levels.emplace_back(blocks::levelBytes(texture, level));
    for (std::byte& byte : levels.back()) byte = static_cast<std::byte>(random());
  }
  return levels;
}

/// As bands come: level 0 a few rows at a time, with rows of smaller levels in between.
inline void writeTexture(const std::filesystem::path& path, const blocks::BlockTexture& texture,
                         const BlockLevels& levels) {
  blocks::TextureFileWriter writer(path, texture);
  std::vector<int> done(levels.size());
  for (bool more = true; more;) {
    more = false;
    for (int level = 0; level < texture.levels; ++level) {
      const auto l = static_cast<std::size_t>(level);
      const int rows = std::min(level == 0 ? 3 : 1, blocks::blockRows(texture, level) - done[l]);
      const std::size_t row_bytes = blocks::blockRowBytes(texture, level);
      writer.append(level, std::span(levels[l]).subspan(static_cast<std::size_t>(done[l]) * row_bytes,
                                                        static_cast<std::size_t>(rows) * row_bytes));
      done[l] += rows;
      more |= done[l] < blocks::blockRows(texture, level);
    }
  }
  writer.close();
}

inline blocks::TextureFileReader openTexture(const std::filesystem::path& path) {
  return blocks::TextureFileReader(path, InputFile(path, "a texture"));
}

/// Bytes as a file of that name; in memory, since there are thousands of them.
inline blocks::TextureFileReader openBytes(const std::string& name, std::string_view bytes) {
  const int descriptor = ::memfd_create("texture", MFD_CLOEXEC);
  if (::write(descriptor, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) throw std::bad_alloc();
  InputFile file(fmt::format("/proc/self/fd/{}", descriptor), "a texture");
  ::close(descriptor);
  return blocks::TextureFileReader(name, std::move(file));
}

/// What is wrong with them.
inline std::string itemOf(const std::string& name, std::string_view bytes) {
  try {
    openBytes(name, bytes);
  } catch (const InputError& error) {
    EXPECT_EQ(error.parts().file, name);
    return error.parts().item;
  }
  return "was read";
}

inline void save(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline void replaceWord(std::string& bytes, std::size_t offset, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[offset + i] = static_cast<char>(value >> (8 * i));
}

inline constexpr std::array kContainers = {"texture.ktx2", "texture.dds"};

struct ForeignField {
  std::size_t offset;
  std::uint32_t value;
  const char* item;  ///< that is wrong then
};

}  // namespace facezip::test
