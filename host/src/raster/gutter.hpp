// gutter.hpp - texels beside the islands, and those beside the region, take the surface point of the nearest covered
// texel.
#pragma once

#include <span>

#include "raster/uv_raster.hpp"

namespace facezip::raster {

/// How far, Euclidean, in texels.
struct Reaches {
  int gutter = 0;   ///< of kEmpty texels, which become kGutter
  int feather = 0;  ///< of kOutside ones, which become kFeather
};

/// Makes the kEmpty texels of rows [begin, end) that have a covered texel within the gutter kGutter, and the kOutside
/// ones that have one within the feather, with no kEmpty texel on the line to it, kFeather: they fade from 1 at the
/// region's border to 0 at the feather's end, smoothly at both. Exact distances, in time that does not depend on the
/// gutter: Meijster, Roerdink and Hesselink, "A general algorithm for computing distance transforms in linear time"
/// (2000). Ties go to the row above, then to the column on the left. covered  rows [covered_begin, covered_end):
/// [begin, end) and up to the larger reach in rows to either side, `width` per row samples  rows [begin, end) of the
/// same
void fillGutter(std::span<const TexelSample> covered, int width, int covered_begin, int covered_end, int begin, int end,
                const Reaches& reaches, std::span<TexelSample> samples);

}  // namespace facezip::raster
