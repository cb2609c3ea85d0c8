#include "blocks/block_texture.hpp"

#include <algorithm>
#include <bit>

namespace facezip::blocks {

int levelSide(int side, int level) { return std::max(1, side >> level); }

int mostLevels(int width, int height) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(width, height))));
}

int blockRows(const BlockTexture& texture, int level) {
  return blockCount(levelSide(texture.height, level), infoOf(texture.format).block_height);
}

std::size_t blockRowBytes(const BlockTexture& texture, int level) {
  return blockBytes(texture.format, levelSide(texture.width, level), 1);
}

std::size_t levelBytes(const BlockTexture& texture, int level) {
  return blockBytes(texture.format, levelSide(texture.width, level), levelSide(texture.height, level));
}

}  // namespace facezip::blocks
