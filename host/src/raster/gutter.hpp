// gutter.hpp - texels beside the islands take the surface point of the nearest covered texel.
#pragma once

#include <span>

#include "raster/uv_raster.hpp"

namespace facezip::raster {

/// Makes the kEmpty texels of rows [begin, end) that have a covered texel within `gutter` (Euclidean, in texels)
/// kGutter. Exact distances, in time that does not depend on the gutter: Meijster, Roerdink and Hesselink, "A general
/// algorithm for computing distance transforms in linear time" (2000). Ties go to the row above, then to the column on
/// the left. covered  rows [covered_begin, covered_end): [begin, end) and up to `gutter` rows to either side, `width`
/// per row samples  rows [begin, end) of the same
void fillGutter(std::span<const TexelSample> covered, int width, int covered_begin, int covered_end, int begin, int end,
                int gutter, std::span<TexelSample> samples);

}  // namespace facezip::raster
