// difference_texture_range.hpp - how far difference textures reach, which their encoding must hold.
#pragma once

#include <span>
#include <vector>

#include "bands/device_tiles.hpp"
#include "bands/tile_band.hpp"
#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "refine/texture_encoding.hpp"

namespace facezip::compress {

class TextureRangeFinder {
 public:
  /// textures  C, 1 to 8
  TextureRangeFinder(device::DeviceContext& context, int textures)
      : context_(context), textures_count_(textures), ranges_(context, "ranges of the difference textures") {}

  /// Range of each texture and channel in each of tiles [first, end), over the texels where a mask is above 0 (gutter
  /// too): entry (tile - first) * C * shape.channels + texture * shape.channels + channel. Waits.
  /// textures  [tile][C][channel][256] float
  std::vector<TextureRange> findPerTile(const DeviceTiles& tiles, const BandShape& shape, const cl::Buffer& textures,
                                        std::size_t first, std::size_t end);

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

/// Ranges of `planes` textures and channels from those of their tiles, [tile][plane]: all but a share of `clipped` of
/// the tiles lie within them at either end. A few far texels would coarsen the codes of all others.
/// most  how far a tile may reach beyond, [tile][plane], where the range need not be three quarters wider for that;
///       empty: any way
std::vector<TextureRange> clippedRange(std::span<const TextureRange> tiles, std::size_t planes, double clipped,
                                       std::span<const float> most = {});

/// Makes every range of `whole` hold the one of `part`. An empty `whole` becomes `part`.
void widen(std::vector<TextureRange>& whole, std::span<const TextureRange> part);

}  // namespace facezip::compress
