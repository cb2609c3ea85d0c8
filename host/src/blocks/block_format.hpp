// block_format.hpp - what files, graphics APIs and encoders know of block formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "facezip/block_format.hpp"

namespace facezip::blocks {

using facezip::BlockFormat;
using facezip::blockFormatNames;
using facezip::blockFormatOf;

/// What files and graphics APIs call a format.
struct BlockFormatInfo {
  BlockFormat format;
  std::string_view name;  ///< on the command line: "bc7", "astc-6x6"
  int block_width;        ///< texels of a block
  int block_height;
  int block_bytes;   ///< 8 or 16
  int max_channels;  ///< a texture of 1 to that many channels can be stored
  /// VkFormat, which is KTX2's, of samples as they are stored; with sRGB's curve undone on sampling, 0 where there is
  /// none.
  std::uint32_t vk_unorm;
  std::uint32_t vk_srgb;
  /// DXGI_FORMAT, which is DDS's; 0 where there is none.
  std::uint32_t dxgi_unorm;
  std::uint32_t dxgi_srgb;
};

/// All formats, in the order of the enumeration.
std::span<const BlockFormatInfo> blockFormats();
const BlockFormatInfo& infoOf(BlockFormat format);

/// Whether blocks are ASTC's, which libastcenc codes; all others are coded here.
bool isAstc(BlockFormat format);

/// Blocks along `texels`, and bytes of a texture of width x height texels. Sizes need not be multiples of the block.
int blockCount(int texels, int block_side);
std::size_t blockBytes(BlockFormat format, int width, int height);

/// The format in which a map of so many channels gets what was asked for: BC4 and BC5 have one and two channels, which
/// BC1 and BC7 would waste bits beside; BC1 has no fourth.
BlockFormat formatFor(BlockFormat wanted, int channels);

/// Throws InputError when a texture of so many channels cannot be stored in the format.
void requireChannels(BlockFormat format, int channels);

}  // namespace facezip::blocks
