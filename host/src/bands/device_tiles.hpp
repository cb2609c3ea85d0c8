// device_tiles.hpp - the tiles of one band and their masks, on the device.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bands/tile_band.hpp"
#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"

namespace facezip::compress {

/// Uploads the TileMasks of one band after another into the same memory. Every map of a band uses one upload.
class DeviceTiles {
 public:
  explicit DeviceTiles(device::DeviceContext& context);

  /// Replaces the band. `masks` may go afterwards. Throws DeviceError when it does not fit.
  void upload(const TileMasks& masks);

  std::size_t tileCount() const { return tile_count_; }
  /// Masks that are active in tile `t`, rising (host memory).
  std::span<const int> masksOf(std::size_t t) const;

  // Device memory, laid out as TileMasks is.
  const cl::Buffer& positions() const { return positions_.buffer(); }         ///< [tile] int2, in tiles
  const cl::Buffer& maskBegin() const { return mask_begin_.buffer(); }        ///< [tile + 1] int
  const cl::Buffer& maskIndex() const { return mask_index_.buffer(); }        ///< [entry] int, in [0, K)
  const cl::Buffer& maskWeights() const { return mask_weights_.buffer(); }    ///< [entry][256] float
  const cl::Buffer& texelWeights() const { return texel_weights_.buffer(); }  ///< [tile][256] float
  bool hasFades() const { return has_fades_; }
  const cl::Buffer& fades() const { return fades_.buffer(); }  ///< [tile][256] float, where there are any

 private:
  std::size_t tile_count_ = 0;
  std::vector<int> begin_;
  std::vector<int> index_;
  device::PooledBuffer positions_;
  device::PooledBuffer mask_begin_;
  device::PooledBuffer mask_index_;
  device::PooledBuffer mask_weights_;
  device::PooledBuffer texel_weights_;
  device::PooledBuffer fades_;
  bool has_fades_ = false;
};

}  // namespace facezip::compress
