// block_size.hpp - what block formats take in memory.
#pragma once

#include <cstdint>

#include "facezip/block_format.hpp"

namespace facezip {

/// Texels along the sides of a block, and its bytes.
struct BlockSize {
  int width = 0;
  int height = 0;
  int bytes = 0;
};
BlockSize blockSize(BlockFormat format);

/// Bytes of a texture of so many texels, without mip levels. Sides need not be multiples of the block's.
std::uint64_t blockTextureBytes(BlockFormat format, int width, int height);

}  // namespace facezip
