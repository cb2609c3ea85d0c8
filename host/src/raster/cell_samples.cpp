#include "raster/cell_samples.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

namespace facezip::raster {

std::vector<TexelSample> cellSamples(const UvRaster& raster, int scale) {
  const int columns = (raster.width() + scale - 1) / scale;
  const int rows = (raster.height() + scale - 1) / scale;
  std::vector<TexelSample> cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  tbb::parallel_for(0, rows, [&](int row) {
    const int begin = row * scale;
    const int end = std::min(begin + scale, raster.height());
    const std::vector<TexelSample> samples = raster.coveredRows(begin, end);
    std::vector<int> nearest(static_cast<std::size_t>(columns), std::numeric_limits<int>::max());
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < raster.width(); ++x) {
        const TexelSample& sample = samples[static_cast<std::size_t>((y - begin) * raster.width() + x)];
        if (sample.kind != TexelSample::Kind::kCovered) continue;
        const int dx = 2 * (x % scale) + 1 - scale, dy = 2 * (y - begin) + 1 - scale;
        int& best = nearest[static_cast<std::size_t>(x / scale)];
        if (dx * dx + dy * dy >= best) continue;
        best = dx * dx + dy * dy;
        cells[static_cast<std::size_t>(row * columns + x / scale)] = sample;
      }
    }
  });
  return cells;
}

std::vector<int> nearestSampled(const std::vector<TexelSample>& cells, int columns, int rows) {
  std::vector<int> source(cells.size(), -1);
  std::queue<int> front;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (cells[c].triangle < 0) continue;
    source[c] = static_cast<int>(c);
    front.push(static_cast<int>(c));
  }
  for (; !front.empty(); front.pop()) {
    const int cell = front.front(), x = cell % columns, y = cell / columns;
    for (const auto& [nx, ny] : {std::pair{x - 1, y}, std::pair{x + 1, y}, std::pair{x, y - 1}, std::pair{x, y + 1}}) {
      if (nx < 0 || ny < 0 || nx >= columns || ny >= rows) continue;
      int& next = source[static_cast<std::size_t>(ny * columns + nx)];
      if (next >= 0) continue;
      next = source[static_cast<std::size_t>(cell)];
      front.push(ny * columns + nx);
    }
  }
  return source;
}

}  // namespace facezip::raster
