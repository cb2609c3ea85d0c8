// half_cells.hpp - the refinement's turns on sums over texels instead of the texels themselves.
// Inside a quarter of a cell of the weight grid the weights hardly vary. With those of its centre for all its texels,
// the difference textures that suit them enter the equations of the weights through the N x N Gram matrix of the
// differences there alone: a turn costs what N^2 numbers per half cell do, a tenth of its texels, and each map is read
// once.
#pragma once

#include "device/device_context.hpp"
#include "device/pooled_buffer.hpp"
#include "refine/half_cell_fit.hpp"
#include "refine/half_cell_gram.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

class HalfCells {
 public:
  HalfCells(device::DeviceContext& context, const WeightSpace& space);

  /// True if half cells are whole and lie inside tiles: a scale of 4, 8, 16 or 32 texels per cell.
  static bool canHold(int weight_scale);
  /// Bytes of Gram matrices and equations per row of cells.
  static std::size_t bytesOfCellRow(const WeightSpace& space);

  /// Starts a window: the half cells that its free rows interpolate from, from nothing.
  void moveTo(const WindowRows& rows);

  /// Adds the differences of a map. Does not wait.
  /// tile_at  tileLookup() of the band
  void add(const GridBand& band, const cl::Buffer& tile_at, double metric_weight);

  /// Fits difference textures to the weights of the window, as far as the equations show them. Does not wait.
  void fit(const WeightWindow& window, float ridge);

  /// Squared error of the last fit() over the free rows, with the texels' and maps' weights. Waits.
  double error();

  /// What fit() left: [half row][half column][entries] float, half rows from rows().first on; half_cell_fit.cl.
  const cl::Buffer& equations() const { return halves_.buffer(); }
  const HalfCellRows& rows() const { return rows_; }

  /// [half row][group of 16][m (m + 1) / 2 + n][16] float, for tests.
  const cl::Buffer& grams() const { return grams_.buffer(); }

 private:
  device::DeviceContext& context_;
  WeightSpace space_;
  WindowRows window_rows_;
  HalfCellRows rows_;
  bool empty_ = true;
  device::PooledBuffer grams_;
  device::PooledBuffer halves_;
  device::PooledBuffer errors_;
};

}  // namespace facezip::compress
