// grid_weights.hpp - weight maps in host memory: as real numbers while they are fitted, then as the bytes of a package.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "io/counts.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// Weight maps as a package holds them: W = scale[i] * code + offset[i].
struct EncodedWeights {
  std::vector<double> scale;        ///< C, 0 or more
  std::vector<double> offset;       ///< C
  std::vector<std::uint8_t> codes;  ///< [N][cell][C]
};

/// What may lie beyond the ends of a range that codes are spread over: a few far values would coarsen all others, and
/// those that are clamped by much show.
struct Clipping {
  double share = 0.0;  ///< of the values, at either end
  float most = 0.0f;   ///< how far they may lie beyond
};

/// Weights of the whole grid in half precision: an eighth of a code's step where weights reach from -4 to 4.
class GridWeights {
 public:
  explicit GridWeights(const WeightSpace& space);

  const WeightSpace& space() const { return space_; }
  float at(std::size_t cell, int texture, int expression) const {
    return static_cast<float>(values_[index(cell, texture, expression)]);
  }

  /// Between here and the rows of a WeightWindow, [row][column][C][lanes].
  void store(int begin, int end, std::span<const float> rows);
  void load(int begin, int end, std::span<float> rows) const;

  /// Bytes, with the range of each channel taken from the cells that `used` marks. Values beyond it are clamped.
  EncodedWeights encode(std::span<const std::uint8_t> used, Clipping clipping) const;

 private:
  std::size_t index(std::size_t cell, int texture, int expression) const {
    return (cell * toSize(space_.textures) + toSize(texture)) * toSize(space_.expressions) + toSize(expression);
  }
  std::pair<float, float> rangeOf(int texture, std::span<const std::uint8_t> used, Clipping clipping) const;

  WeightSpace space_;
  std::vector<Eigen::half> values_;  ///< [cell][C][N]
};

/// What the run time decodes of rows [begin, end), [row][column][C][lanes].
void decodeRows(const EncodedWeights& weights, const WeightSpace& space, int begin, int end, std::span<float> rows);

}  // namespace facezip::compress
