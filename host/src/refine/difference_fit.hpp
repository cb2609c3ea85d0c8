// difference_fit.hpp - the difference textures that suit given weights best, texel by texel ("closed loop").
//   D(p) = argmin sum_n |Delta_n(p) - D^T w_n(p)|^2 + ridge |D|^2
// w_n is what the run time makes of the weight maps: bilinear between the cells (FaceZip, Eq. 8).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "refine/grid_band.hpp"
#include "refine/texture_encoding.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// Squared error that is left in one tile, in (1/255)^2, summed over expressions and channels.
struct FitError {
  double weighted = 0.0;  ///< over the covered texels, each times its texel weight
  double plain = 0.0;     ///< each counted once
};

/// Errors of tiles from the sums that work-items left, [tile][sums_of_tile] float2: weighted, plain. Waits.
std::vector<FitError> addTileErrors(device::PooledBuffer& sums, std::size_t tiles, std::size_t sums_of_tile);

/// Numbers of a texel's factored system.
int differenceFactorPlanes(const WeightSpace& space, int channels);

class DifferenceFit {
 public:
  /// variant  16 x 16 texels (kCpu) or one (kGpu) to a work-item
  DifferenceFit(device::DeviceContext& context, const WeightSpace& space,
                device::KernelVariant variant = device::KernelVariant::kAuto);

  /// Computes the textures of a band: [tile][C][channel][256] float in units of 1/255, 0 where a tile's mask is 0.
  /// Does not wait. The cells that the band's texels interpolate between must be in the window.
  /// ridge  above 0; keeps textures tame where the weights say little
  const cl::Buffer& compute(const GridBand& band, const WeightWindow& window, float ridge);

  /// The same, rounded to codes of `bits` bits as the system is substituted back (Babai's nearest plane).
  /// encoding  C x shape.channels
  const cl::Buffer& computeRounded(const GridBand& band, const WeightWindow& window, float ridge,
                                   std::span<const TextureEncoding> encoding, int bits);

  /// The systems of the band's texels, factored and not solved, for textures that are coded one after the other
  /// (kernels/cl/difference_factors.h): [tile][differenceFactorPlanes()][256] float. Does not wait.
  const cl::Buffer& computeFactors(const GridBand& band, const WeightWindow& window, float ridge);

  const cl::Buffer& textures() const { return textures_.buffer(); }

  /// What the last compute() leaves in every tile. Waits.
  std::vector<FitError> errors();

 private:
  const cl::Buffer& run(const GridBand& band, const WeightWindow& window, float ridge, const std::string& form);

  device::DeviceContext& context_;
  WeightSpace space_;
  bool gpu_;
  std::size_t tile_count_ = 0;
  device::PooledBuffer textures_;
  device::PooledBuffer factors_;
  device::PooledBuffer errors_;
  device::PooledBuffer encoding_;
};

}  // namespace facezip::compress
