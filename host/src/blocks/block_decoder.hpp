// block_decoder.hpp - the texels of blocks, on the host. Decoding takes any bytes: blocks that no encoder makes decode
// to what the formats say of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "blocks/block_format.hpp"

namespace facezip::blocks {

class BlockDecoder {
 public:
  virtual ~BlockDecoder() = default;

  /// blocks  [block row][block column], exactly blockBytes(format, width, rows) bytes
  /// texels  rows x width x channels, code units 0 to 255; bytes are rounded, halves upwards
  virtual void decode(int width, int rows, std::span<const std::byte> blocks, std::span<float> texels) = 0;
  virtual void decode(int width, int rows, std::span<const std::byte> blocks, std::span<std::uint8_t> texels) = 0;
};

/// channels  of the texture, 1 to infoOf(format).max_channels; of BC1 and BC7 those beyond are not written
/// Throws InputError as makeBlockEncoder() does.
std::unique_ptr<BlockDecoder> makeBlockDecoder(BlockFormat format, int channels);

}  // namespace facezip::blocks
