// block_texture.hpp - a texture of blocks with its mip levels, and where they lie in a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "blocks/block_format.hpp"

namespace facezip::blocks {

struct BlockTexture {
  BlockFormat format = BlockFormat::kBc7;
  int width = 0;  ///< texels of level 0
  int height = 0;
  int levels = 1;     ///< 1 to mostLevels(width, height)
  bool srgb = false;  ///< samplers undo sRGB's curve; only of formats that have a variant for that

  bool operator==(const BlockTexture&) const = default;
};

/// Texels along a side of a level: half of the one before, rounded down, never below 1.
int levelSide(int side, int level);
/// Levels down to the one of a single texel.
int mostLevels(int width, int height);

/// Of one level: rows of blocks, bytes of a row of blocks, bytes of all.
int blockRows(const BlockTexture& texture, int level);
std::size_t blockRowBytes(const BlockTexture& texture, int level);
std::size_t levelBytes(const BlockTexture& texture, int level);

/// Blocks of level l, [block row][block column], stand from level_begins[l] on.
struct TextureInFile {
  BlockTexture texture;
  std::vector<std::uint64_t> level_begins;
  std::uint64_t file_bytes = 0;
};

}  // namespace facezip::blocks
