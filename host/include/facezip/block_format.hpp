// block_format.hpp - block-compressed texture formats: textures that GPUs hold as blocks of a few texels each and
// decode while they sample.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace facezip {

enum class BlockFormat {
  kBc1,
  kBc4,
  kBc5,
  kBc7,
  kAstc4x4,
  kAstc5x4,
  kAstc5x5,
  kAstc6x5,
  kAstc6x6,
  kAstc8x5,
  kAstc8x6,
  kAstc8x8,
  kAstc10x5,
  kAstc10x6,
  kAstc10x8,
  kAstc10x10,
  kAstc12x10,
  kAstc12x12,
};

/// "bc7", "astc-6x6": what the command line, package.json and reports call a format.
std::string_view blockFormatName(BlockFormat format);

/// Texels along the sides of a block, and its bytes.
struct BlockSize {
  int width = 0;
  int height = 0;
  int bytes = 0;
};
BlockSize blockSize(BlockFormat format);

/// Bytes of a texture of so many texels, without mip levels. Sides need not be multiples of the block's.
std::uint64_t blockTextureBytes(BlockFormat format, int width, int height);

/// The format of that name, with `option` named in the error. Throws InputError that lists the names there are.
BlockFormat blockFormatOf(std::string_view name, std::string_view option);

/// "bc1, bc4, ...", for messages and help.
std::string blockFormatNames();

}  // namespace facezip
