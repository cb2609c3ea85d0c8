// weight_grid.hpp - the grid of cells that weight maps live on, a fraction of a texture's size.
// Cell q has its centre at texel (q + 1/2) s - 1/2, s texels to a cell along each axis; a texel interpolates linearly
// between the centres around it, and beyond the outer centres the edge repeats (kernels/cl/weight_grid.h, FaceZip Eq.
// 8).
#pragma once

#include <algorithm>

#include "io/counts.hpp"

namespace facezip::raster {

/// Rows [begin, end) of cells.
struct CellRows {
  int begin = 0;
  int end = 0;

  int count() const { return end - begin; }
};

/// Maps of several sizes share a grid, each with a scale of its own. Cells are counted row by row.
struct WeightGrid {
  int columns = 0;  ///< cells
  int rows = 0;     ///< cells

  /// The grid over an image of width x height texels with `scale` texels to a cell; the last cells may hang over.
  static WeightGrid over(int width, int height, int scale) { return {divideUp(width, scale), divideUp(height, scale)}; }

  std::size_t cellCount() const { return toSize(rows, columns); }
  std::size_t cell(int row, int column) const { return Layout(rows, columns)(row, column); }
};

/// Rows of cells that texel rows [begin, end) interpolate between; one at least, whatever the rows.
/// scale  texels to a cell; grid_rows  of the whole grid
inline CellRows cellRowsOf(int begin, int end, int scale, int grid_rows) {
  // 2 s times the position of texel row y in cells is the integer 2 y + 1 - s: exact for every s and y.
  const auto row_above = [scale](int y) { return divideDown(2 * y + 1 - scale, 2 * scale); };
  const int first = std::clamp(row_above(begin), 0, grid_rows - 1);
  return {first, std::clamp(row_above(std::max(begin, end - 1)) + 2, first + 1, grid_rows)};
}

}  // namespace facezip::raster
