// fuzz_texture.hpp - textures of blocks, read as packages do.
#pragma once

#include <cstdlib>
#include <vector>

#include "blocks/texture_file.hpp"
#include "fuzz_input.hpp"

namespace facezip::fuzz {

inline void readTexture(const char* name, const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  refuseOrRead([&] {
    const blocks::TextureFileReader reader(name, file.open());
    const blocks::BlockTexture& texture = reader.texture();
    if (texture.levels < 1 || texture.levels > blocks::mostLevels(texture.width, texture.height)) std::abort();
    std::vector<std::byte> row(blocks::blockRowBytes(texture, 0));
    std::size_t bytes = 0;
    for (int level = texture.levels - 1; level >= 0; --level) {
      row.resize(blocks::blockRowBytes(texture, level));
      for (int r = blocks::blockRows(texture, level) - 1; r >= 0; --r) {
        reader.readRows(level, r, r + 1, row);
        bytes += row.size();
      }
    }
    // What a header claims, the file has.
    if (bytes >= size) std::abort();
  });
}

}  // namespace facezip::fuzz
