#include "raster/cell_samples.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "io/counts.hpp"
#include "raster/nearest_marked.hpp"

namespace facezip::raster {

std::vector<TexelSample> cellSamples(const UvRaster& raster, int scale) {
  const int columns = (raster.width() + scale - 1) / scale;
  const int rows = (raster.height() + scale - 1) / scale;
  std::vector<TexelSample> cells(toSize(columns, rows));
  tbb::parallel_for(0, rows, [&](int row) {
    const int begin = row * scale;
    const int end = std::min(begin + scale, raster.height());
    const std::vector<TexelSample> samples = raster.coveredRows(begin, end);
    std::vector<int> nearest(toSize(columns), std::numeric_limits<int>::max());
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < raster.width(); ++x) {
        const TexelSample& sample = samples[toSize((y - begin) * raster.width() + x)];
        if (sample.kind != TexelSample::Kind::kCovered) continue;
        const int dx = 2 * (x % scale) + 1 - scale, dy = 2 * (y - begin) + 1 - scale;
        int& best = nearest[toSize(x / scale)];
        if (dx * dx + dy * dy >= best) continue;
        best = dx * dx + dy * dy;
        cells[toSize(row * columns + x / scale)] = sample;
      }
    }
  });
  return cells;
}

std::vector<int> nearestSampled(const std::vector<TexelSample>& cells, int columns, int rows) {
  std::vector<std::uint8_t> sampled;
  for (const TexelSample& cell : cells) sampled.push_back(cell.triangle >= 0);
  return nearestMarked(sampled, columns, rows);
}

}  // namespace facezip::raster
