// Reference for kernels/cl/difference_texture_range.cl: how far one texture of one tile reaches under its masks.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace facezip::reference {

/// values, masks  256 each
/// Returns smallest and largest value where a mask is above 0; (infinity, -infinity) if none is.
inline std::pair<float, float> rangeUnderMasks(const float* values, const std::vector<const float*>& masks) {
  std::pair<float, float> range{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  for (int t = 0; t < 256; ++t) {
    const bool covered = std::any_of(masks.begin(), masks.end(), [t](const float* mask) { return mask[t] > 0.0f; });
    if (covered) range = {std::min(range.first, values[t]), std::max(range.second, values[t])};
  }
  return range;
}

}  // namespace facezip::reference
