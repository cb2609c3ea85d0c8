// difference_texture_encode.hpp - difference textures as integer codes in rows, as a package's images hold them.
#pragma once

#include <cstddef>
#include <span>

#include "bands/device_tiles.hpp"
#include "bands/tile_band.hpp"
#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "refine/texture_encoding.hpp"

namespace facezip::compress {

class TextureEncoder {
 public:
  /// textures  C, 1 to 8
  TextureEncoder(device::DeviceContext& context, int textures)
      : context_(context),
        textures_count_(textures),
        encoding_(context, "encoding of the difference textures", CL_MEM_READ_ONLY),
        codes_(context, "codes of the difference textures") {}

  /// Encodes `textures`, [tile][C][channel][256] float, into `codes`, [texture][shape.rows][shape.width][channel]: the
  /// code nearest to the value, halves upwards, clamped to the codes there are. Texels outside the tiles get the code
  /// of 0. Waits.
  /// encoding  C x shape.channels
  /// bits      of a code: 8 or 16, 16-bit codes in the byte order of the host
  /// codes     exactly C * rows * width * channels * bits / 8 bytes
  void encode(const DeviceTiles& tiles, const BandShape& shape, const cl::Buffer& textures,
              std::span<const TextureEncoding> encoding, int bits, std::span<std::byte> codes);

 private:
  void clear(const BandShape& shape, int bits);

  device::DeviceContext& context_;
  int textures_count_;
  device::PooledBuffer encoding_;
  device::PooledBuffer codes_;
};

}  // namespace facezip::compress
