#include "raster/weight_grid.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>

#include "raster/nearest_marked.hpp"

namespace facezip::raster {
namespace {

/// Appends the mean of the masks over the covered texels of a cell.
/// sums  of every mask; all zero between calls
void appendCell(TexelMasks::Cursor& cursor, const std::vector<TexelSample>& samples, int image_width, int rows,
                int cell_x, int scale, std::vector<float>& sums, compress::CellMasks& out) {
  std::vector<int> touched;
  int covered = 0;
  const int x_end = std::min(image_width, (cell_x + 1) * scale);
  for (int y = 0; y < rows; ++y) {
    for (int x = cell_x * scale; x < x_end; ++x) {
      const TexelSample& sample =
          samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_width) + static_cast<std::size_t>(x)];
      if (sample.kind != TexelSample::Kind::kCovered) continue;
      ++covered;
      for (const TexelMasks::Corners& corners : cursor.at(sample.triangle)) {
        const float value = corners.at(sample);
        float& sum = sums[static_cast<std::size_t>(corners.mask)];
        if (sum == 0.0f && value > 0.0f) touched.push_back(corners.mask);
        sum += value;
      }
    }
  }
  std::sort(touched.begin(), touched.end());
  for (const int mask : touched) {
    float& sum = sums[static_cast<std::size_t>(mask)];
    out.mask_index.push_back(mask);
    out.mask_weights.push_back(sum / static_cast<float>(covered));
    sum = 0.0f;
  }
  out.cell_begin.push_back(static_cast<int>(out.mask_index.size()));
}

/// Appends cell `column` of `row` to `out`.
void copyCell(const compress::CellMasks& row, int column, compress::CellMasks& out) {
  const auto begin = static_cast<std::ptrdiff_t>(row.cell_begin[static_cast<std::size_t>(column)]);
  const auto end = static_cast<std::ptrdiff_t>(row.cell_begin[static_cast<std::size_t>(column) + 1]);
  out.mask_index.insert(out.mask_index.end(), row.mask_index.begin() + begin, row.mask_index.begin() + end);
  out.mask_weights.insert(out.mask_weights.end(), row.mask_weights.begin() + begin, row.mask_weights.begin() + end);
}

}  // namespace

WeightGrid makeWeightGrid(const TexelMasks& masks, const UvRaster& raster, int scale) {
  assert(scale >= 1);
  WeightGrid grid;
  grid.width = (raster.width() + scale - 1) / scale;
  grid.height = (raster.height() + scale - 1) / scale;
  std::vector<compress::CellMasks> rows(static_cast<std::size_t>(grid.height));
  tbb::parallel_for(0, grid.height, [&](int cell_y) {
    const int begin = cell_y * scale;
    const int end = std::min(raster.height(), begin + scale);
    const std::vector<TexelSample> samples = raster.coveredRows(begin, end);
    TexelMasks::Cursor cursor(masks);
    std::vector<float> sums(static_cast<std::size_t>(masks.maskCount()), 0.0f);
    compress::CellMasks& row = rows[static_cast<std::size_t>(cell_y)];
    row.cell_begin.push_back(0);
    for (int x = 0; x < grid.width; ++x) {
      appendCell(cursor, samples, raster.width(), end - begin, x, scale, sums, row);
    }
  });
  for (const compress::CellMasks& row : rows) {
    for (std::size_t x = 0; x < row.cells(); ++x) grid.covered.push_back(row.cell_begin[x] < row.cell_begin[x + 1]);
  }
  compress::CellMasks& out = grid.cells;
  out.cell_begin.push_back(0);
  for (const int from : nearestMarked(grid.covered, grid.width, grid.height)) {
    if (from >= 0) copyCell(rows[static_cast<std::size_t>(from / grid.width)], from % grid.width, out);
    out.cell_begin.push_back(static_cast<int>(out.mask_index.size()));
  }
  return grid;
}

}  // namespace facezip::raster
