// difference_texture.hpp - the difference textures D_i of one band (FaceZip, Eq. 5).
//   D_i(p) = sum_k M_k(p) * sum_n coefficients[k][i][n] * Delta_n(p)
// M_k here includes the gutter around the covered texels, so that bilinear and mip sampling never meet an empty texel.
#pragma once

#include <cstddef>
#include <vector>

#include "bands/device_tiles.hpp"
#include "bands/tile_band.hpp"
#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"

namespace facezip::compress {

/// How the differences of N expressions make the C textures of each of K masks.
struct TextureCoefficients {
  int masks = 0;              ///< K
  int textures = 0;           ///< C, 1 to 8
  int expressions = 0;        ///< N
  std::vector<float> values;  ///< K x C x N; for Eq. 5: 1/|cluster| if n lies in cluster sigma(i, k) of mask k, else 0
};

class DifferenceTextures {
 public:
  /// Uploads the table. Throws DeviceError.
  /// variant  how many texels a work-item takes; the bits of the result do not depend on it
  DifferenceTextures(device::DeviceContext& context, const TextureCoefficients& coefficients,
                     device::KernelVariant variant = device::KernelVariant::kAuto);

  /// Computes the textures of a band: [tile][texture][channel][256] float, units of 1/255; 0 where no mask is active.
  /// Returns the buffer, which the next call overwrites. Does not wait.
  /// differences  what computeDifferences() wrote for the same tiles and shape
  const cl::Buffer& compute(const DeviceTiles& tiles, const cl::Buffer& differences, const BandShape& shape);

  /// What compute() made last.
  const cl::Buffer& textures() const { return textures_.buffer(); }

 private:
  std::size_t textureBytes(const DeviceTiles& tiles, const BandShape& shape) const;

  device::DeviceContext& context_;
  device::KernelVariant variant_;
  int textures_count_;
  int expressions_;
  cl::Buffer coefficients_;
  device::PooledBuffer textures_;
};

}  // namespace facezip::compress
