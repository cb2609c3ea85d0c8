// weight_window.hpp - a few rows of the weight grid on the device, with free weights and where they started.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "cl/layout.h"
#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "io/counts.hpp"
#include "raster/weight_grid.hpp"

namespace facezip::compress {

/// The weight maps that are being solved for: a grid with the weights of N expressions for C textures in each cell.
struct WeightSpace : raster::WeightGrid {
  int textures = 0;     ///< C, 1 to 8
  int expressions = 0;  ///< N

  /// N as device buffers have it: a multiple of 16, the rest is 0.
  std::size_t lanes() const { return roundUp(toSize(expressions), FACEZIP_VECTOR); }
  std::size_t cellFloats() const { return toSize(textures) * lanes(); }
  std::size_t rowFloats() const { return toSize(columns) * cellFloats(); }
  /// Numbers that the normal equations of a cell take, as kernels/cl/weight_system.cl lays them out.
  std::size_t systemEntries() const { return toSize(FACEZIP_CELL_MATRICES(textures)) + cellFloats(); }
};

/// Rows [begin, end) of the grid are held; the weights of rows [free_begin, free_end) may change.
struct WindowRows : raster::CellRows {
  WindowRows() = default;
  WindowRows(int held_begin, int held_end, int first_free, int behind_free)
      : CellRows{held_begin, held_end}, free_begin(first_free), free_end(behind_free) {}
  /// None may change.
  WindowRows(const raster::CellRows& held) : WindowRows(held.begin, held.end, held.begin, held.begin) {}

  int free_begin = 0;
  int free_end = 0;
};
using raster::cellRowsOf;

class WeightWindow {
 public:
  WeightWindow(device::DeviceContext& context, const WeightSpace& space);

  /// Moves the window. Both arrays: [rows.count()][columns][C][lanes].
  /// weights  where the rows stand
  /// start    where the free rows' trust lies
  void set(const WindowRows& rows, std::span<const float> weights, std::span<const float> start);

  /// The weights now, [rows.count()][columns][C][lanes].
  std::vector<float> weights() const;

  const WeightSpace& space() const { return space_; }
  const WindowRows& rows() const { return rows_; }
  const cl::Buffer& weightsBuffer() const { return weights_.buffer(); }
  const cl::Buffer& startBuffer() const { return start_.buffer(); }

 private:
  WeightSpace space_;
  WindowRows rows_;
  device::PooledBuffer weights_;
  device::PooledBuffer start_;
};

}  // namespace facezip::compress
