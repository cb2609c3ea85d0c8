#include "raster/weight_grid.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <queue>

namespace facezip::raster {
namespace {

/// One sparse row.
struct SparseRow {
  std::vector<int> mask_index;
  std::vector<float> weight;
};

SparseRow averageCell(const TexelMasks& masks, const std::vector<TexelSample>& samples, int image_width, int rows,
                      int cell_x, int scale, std::vector<float>& accumulator) {
  std::vector<int> touched;
  int covered = 0;
  const int x_end = std::min(image_width, (cell_x + 1) * scale);
  for (int y = 0; y < rows; ++y) {
    for (int x = cell_x * scale; x < x_end; ++x) {
      const TexelSample& sample =
          samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_width) + static_cast<std::size_t>(x)];
      if (sample.kind != TexelSample::Kind::kCovered) continue;
      ++covered;
      masks.accumulate(sample, 1.0f, accumulator, touched);
    }
  }
  SparseRow cell;
  std::sort(touched.begin(), touched.end());
  for (const int mask : touched) {
    float& sum = accumulator[static_cast<std::size_t>(mask)];
    cell.mask_index.push_back(mask);
    cell.weight.push_back(sum / static_cast<float>(covered));
    sum = 0.0f;
  }
  return cell;
}

/// For every cell the nearest cell (in steps along the grid, ties to the one found first in row-major order) that is
/// not empty: a breadth-first search from all filled cells at once.
std::vector<int> nearestFilled(const std::vector<SparseRow>& cells, int width, int height) {
  std::vector<int> source(cells.size(), -1);
  std::queue<int> front;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (cells[c].mask_index.empty()) continue;
    source[c] = static_cast<int>(c);
    front.push(static_cast<int>(c));
  }
  while (!front.empty()) {
    const int cell = front.front();
    front.pop();
    const int x = cell % width;
    const int y = cell / width;
    for (const auto& [nx, ny] : {std::pair{x - 1, y}, std::pair{x + 1, y}, std::pair{x, y - 1}, std::pair{x, y + 1}}) {
      if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
      int& next = source[static_cast<std::size_t>(ny * width + nx)];
      if (next >= 0) continue;
      next = source[static_cast<std::size_t>(cell)];
      front.push(ny * width + nx);
    }
  }
  return source;
}

}  // namespace

WeightGrid makeWeightGrid(const TexelMasks& masks, const UvRaster& raster, int scale) {
  assert(scale >= 1);
  WeightGrid grid;
  grid.width = (raster.width() + scale - 1) / scale;
  grid.height = (raster.height() + scale - 1) / scale;
  std::vector<SparseRow> cells(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height));
  tbb::parallel_for(0, grid.height, [&](int cell_y) {
    const int begin = cell_y * scale;
    const int end = std::min(raster.height(), begin + scale);
    const std::vector<TexelSample> samples = raster.coveredRows(begin, end);
    std::vector<float> accumulator(static_cast<std::size_t>(masks.maskCount()), 0.0f);
    for (int cell_x = 0; cell_x < grid.width; ++cell_x) {
      cells[static_cast<std::size_t>(cell_y * grid.width + cell_x)] =
          averageCell(masks, samples, raster.width(), end - begin, cell_x, scale, accumulator);
    }
  });
  const std::vector<int> source = nearestFilled(cells, grid.width, grid.height);
  for (const SparseRow& cell : cells) grid.covered.push_back(cell.mask_index.empty() ? 0 : 1);
  compress::CellMasks& out = grid.cells;
  out.cell_begin.push_back(0);
  for (const int from : source) {
    if (from >= 0) {
      const SparseRow& cell = cells[static_cast<std::size_t>(from)];
      out.mask_index.insert(out.mask_index.end(), cell.mask_index.begin(), cell.mask_index.end());
      out.mask_weights.insert(out.mask_weights.end(), cell.weight.begin(), cell.weight.end());
    }
    out.cell_begin.push_back(static_cast<int>(out.mask_index.size()));
  }
  return grid;
}

}  // namespace facezip::raster
