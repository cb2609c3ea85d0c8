#include "raster/grid_masks.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>

#include "io/counts.hpp"
#include "raster/nearest_marked.hpp"

namespace facezip::raster {
namespace {

/// Appends the mean of the masks over the covered texels of a cell.
/// sums  of every mask; all zero between calls
void appendCell(TexelMasks::Cursor& cursor, const std::vector<TexelSample>& samples, int image_width, int rows,
                int cell_x, int scale, std::vector<float>& sums, CellMasks& out) {
  std::vector<int> touched;
  int covered = 0;
  const int x_end = std::min(image_width, (cell_x + 1) * scale);
  for (int y = 0; y < rows; ++y) {
    for (int x = cell_x * scale; x < x_end; ++x) {
      const TexelSample& sample = samples[toSize(y, image_width) + toSize(x)];
      if (sample.kind != TexelSample::Kind::kCovered) continue;
      ++covered;
      for (const TexelMasks::Corners& corners : cursor.at(sample.triangle)) {
        const float value = corners.at(sample);
        float& sum = sums[toSize(corners.mask)];
        if (sum == 0.0f && value > 0.0f) touched.push_back(corners.mask);
        sum += value;
      }
    }
  }
  std::sort(touched.begin(), touched.end());
  for (const int mask : touched) {
    float& sum = sums[toSize(mask)];
    out.mask_index.push_back(mask);
    out.mask_weights.push_back(sum / static_cast<float>(covered));
    sum = 0.0f;
  }
  out.cell_begin.push_back(static_cast<int>(out.mask_index.size()));
}

/// Appends cell `column` of `row` to `out`.
void copyCell(const CellMasks& row, int column, CellMasks& out) {
  const auto begin = static_cast<std::ptrdiff_t>(row.cell_begin[toSize(column)]);
  const auto end = static_cast<std::ptrdiff_t>(row.cell_begin[toSize(column) + 1]);
  out.mask_index.insert(out.mask_index.end(), row.mask_index.begin() + begin, row.mask_index.begin() + end);
  out.mask_weights.insert(out.mask_weights.end(), row.mask_weights.begin() + begin, row.mask_weights.begin() + end);
}

}  // namespace

GridMasks makeGridMasks(const TexelMasks& masks, const UvRaster& raster, int scale) {
  assert(scale >= 1);
  GridMasks grid{WeightGrid::over(raster.width(), raster.height(), scale), {}, {}};
  std::vector<CellMasks> rows(toSize(grid.rows));
  tbb::parallel_for(0, grid.rows, [&](int cell_y) {
    const int begin = cell_y * scale;
    const int end = std::min(raster.height(), begin + scale);
    const std::vector<TexelSample> samples = raster.coveredRows(begin, end);
    TexelMasks::Cursor cursor(masks);
    std::vector<float> sums(toSize(masks.maskCount()), 0.0f);
    CellMasks& row = rows[toSize(cell_y)];
    row.cell_begin.push_back(0);
    for (int x = 0; x < grid.columns; ++x) {
      appendCell(cursor, samples, raster.width(), end - begin, x, scale, sums, row);
    }
  });
  for (const CellMasks& row : rows) {
    for (std::size_t x = 0; x < row.cells(); ++x) grid.covered.push_back(row.cell_begin[x] < row.cell_begin[x + 1]);
  }
  CellMasks& out = grid.cells;
  out.cell_begin.push_back(0);
  for (const int from : nearestMarked(grid.covered, grid.columns, grid.rows)) {
    if (from >= 0) copyCell(rows[toSize(from / grid.columns)], from % grid.columns, out);
    out.cell_begin.push_back(static_cast<int>(out.mask_index.size()));
  }
  return grid;
}

}  // namespace facezip::raster
