// band_differences.hpp - differences of chosen texels of a band as a matrix on the host.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bands/tile_band.hpp"

namespace facezip::compress {

/// Delta_n in units of 1/255: (texel, channel) x N, channels of a texel one below the other.
/// samples  neutral, then expressions, as a MapBand has them
/// texels   row * width + column of the band
Eigen::MatrixXf gatherDifferences(std::span<const std::byte> samples, const BandShape& shape,
                                  std::span<const std::uint32_t> texels);

}  // namespace facezip::compress
