// flow_sampling.hpp - what lies between texels.
#pragma once

#include <cmath>
#include <cstddef>

#include "flow/texture_flow.hpp"

namespace facezip::flow {

/// Where the vector of a texel begins.
inline std::size_t texelAt(const TextureFlow& flow, int x, int y) {
  return 2 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(flow.width) + static_cast<std::size_t>(x));
}

/// The four texels around a place, and what share each has in it.
struct Bilinear {
  Bilinear(double x, double y, int width, int height)
      : inside(x >= 0.0 && y >= 0.0 && x < width - 1.0 && y < height - 1.0),
        column(inside ? static_cast<int>(x) : 0),
        row(inside ? static_cast<int>(y) : 0),
        right(inside ? x - column : 0.0),
        down(inside ? y - row : 0.0) {}

  /// value  of a column and a row: anything that can be added and multiplied by a double
  template <typename Value>
  auto mean(Value&& value) const {
    // Its own type: sums of Eigen's would refer to values that are gone.
    return decltype(value(0, 0))((1.0 - down) * ((1.0 - right) * value(column, row) + right * value(column + 1, row)) +
                                 down * ((1.0 - right) * value(column, row + 1) + right * value(column + 1, row + 1)));
  }

  bool inside;  ///< all four are texels of the picture
  int column, row;
  double right, down;
};

}  // namespace facezip::flow
