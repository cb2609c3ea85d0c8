// weight_blend.hpp - the weight maps of all expressions on a device, and their sum under blendshape weights (Eq. 8).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "cl/layout.h"
#include "device/device_context.hpp"
#include "io/counts.hpp"
#include "raster/weight_grid.hpp"

namespace facezip::blend {

/// A grid with the weight maps of N expressions, and how their codes decode: W = scale[i] * code + offset[i].
struct WeightCodes : raster::WeightGrid {
  int expressions = 0;         ///< N
  std::vector<double> scale;   ///< C
  std::vector<double> offset;  ///< C

  int channels() const { return static_cast<int>(scale.size()); }  ///< C
  /// Blocks of 16 cells, the last one padded.
  std::size_t blocks() const { return divideUp(cellCount(), kBlockCells); }
  std::size_t codeBytes() const { return toSize(blocks(), expressions, channels(), kBlockCells); }
  /// Where the code of `expression`, `cell` (row-major) and `channel` stands in [blocks][N][C][16].
  std::size_t codeIndex(int expression, std::size_t cell, int channel) const {
    return Layout(blocks(), expressions, channels(), kBlockCells)(cell / kBlockCells, expression, channel,
                                                                  cell % kBlockCells);
  }

  static constexpr std::size_t kBlockCells = FACEZIP_VECTOR;
};

/// The device side of kernels/cl/weight_blend.cl.
class WeightMaps {
 public:
  /// codes  grid.codeBytes() bytes in the order of grid.codeIndex()
  /// Throws DeviceError.
  WeightMaps(device::DeviceContext& context, WeightCodes grid, std::span<const std::byte> codes,
             device::KernelVariant variant = device::KernelVariant::kAuto);

  const WeightCodes& grid() const { return grid_; }

  /// Sums the weight maps of cell rows [begin_row, end_row) into weights(); other rows are left as they were.
  /// Expressions whose beta is 0 cost nothing and change no bit.
  /// beta  N values of at most kLargestWeight
  cl::Event blend(std::span<const float> beta, int begin_row, int end_row);
  cl::Event blend(std::span<const float> beta) { return blend(beta, 0, grid_.rows); }

  /// Multiplies what blend() gives from now on, cell by cell, by `gain`: cellCount() factors, row-major; empty: 1.
  void setGain(std::span<const float> gain);

  /// [blocks][C][16] float, the result of blend().
  const cl::Buffer& weights() const { return weights_; }

 private:
  device::DeviceContext& context_;
  WeightCodes grid_;
  std::size_t items_per_block_;
  cl::Kernel kernel_;
  std::size_t local_size_;
  cl::Buffer codes_;
  cl::Buffer active_;
  cl::Buffer beta_;
  cl::Buffer encoding_;
  cl::Buffer gain_;
  cl::Buffer weights_;
  std::vector<cl_int> active_expressions_;
  std::vector<float> active_beta_;
  std::vector<float> decoding_;  // scale_i, then offset_i times the sum of beta
};

/// Throws InputError that names the expression (by index, or by `names` when given) whose weight is above
/// kLargestWeight or NaN, or says how many weights were expected.
void requireWeights(std::span<const float> beta, std::span<const std::string> names);

}  // namespace facezip::blend
