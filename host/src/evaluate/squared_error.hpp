// squared_error.hpp - squared differences of decoded and captured samples over the covered texels.
#pragma once

#include <cstddef>
#include <span>

#include "compress/tile_band.hpp"

namespace facezip::evaluate {

/// Sum over the covered texels and channels of (a - b)^2, in units of (1/255)^2 of full scale.
/// a, b     samples of shape.rows rows, interleaved, in shape.sample_type
/// covered  the band's tiles; texels of weight above 0 count once
/// Summed per tile in double; the order is fixed.
double squaredError(std::span<const std::byte> a, std::span<const std::byte> b, const compress::BandShape& shape,
                    const compress::TileMasks& covered);

}  // namespace facezip::evaluate
