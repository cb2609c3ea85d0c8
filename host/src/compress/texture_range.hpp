// texture_range.hpp - how far difference textures reach, which their encoding must hold.
#pragma once

#include <span>
#include <vector>

#include "compress/device_tiles.hpp"
#include "compress/texture_encoding.hpp"
#include "compress/tile_band.hpp"
#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"

namespace facezip::compress {

class TextureRangeFinder {
 public:
  /// textures  C, 1 to 8
  TextureRangeFinder(device::DeviceContext& context, int textures)
      : context_(context), textures_count_(textures), ranges_(context, "ranges of the difference textures") {}

  /// Range of each texture and channel over the texels of tiles [first, end) where a mask is above 0 (gutter too):
  /// entry texture * shape.channels + channel. Waits.
  /// textures  [tile][C][channel][256] float
  std::vector<TextureRange> find(const DeviceTiles& tiles, const BandShape& shape, const cl::Buffer& textures,
                                 std::size_t first, std::size_t end);

 private:
  device::DeviceContext& context_;
  int textures_count_;
  device::PooledBuffer ranges_;
};

/// Makes every range of `whole` hold the one of `part`. An empty `whole` becomes `part`.
void widen(std::vector<TextureRange>& whole, std::span<const TextureRange> part);

}  // namespace facezip::compress
