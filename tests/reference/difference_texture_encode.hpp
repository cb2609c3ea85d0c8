// Reference for kernels/cl/difference_texture_encode.cl: one value between the codes, in double.
#pragma once

#include <algorithm>

namespace facezip::reference {

/// Where `value` lies on the scale of codes, 0 to `largest`, before rounding.
inline double codePosition(double value, double scale, double offset, double largest) {
  return scale > 0.0 ? std::clamp((value - offset) / scale, 0.0, largest) : 0.0;
}

}  // namespace facezip::reference
