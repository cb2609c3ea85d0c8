// block_format.hpp - block-compressed texture formats: textures that GPUs hold as blocks of a few texels each and
// decode while they sample.
#pragma once

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

/// The format of that name, with `option` named in the error. Throws InputError that lists the names there are.
BlockFormat blockFormatOf(std::string_view name, std::string_view option);

/// "bc1, bc4, ...", for messages and help.
std::string blockFormatNames();

}  // namespace facezip
