// weight_map.hpp - problem of the step `weight_map`.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "problems/guarded_buffer.hpp"
#include "problems/hashed.hpp"
#include "reference/weight_map.hpp"
#include "search/weight_map.hpp"

namespace facezip::test {

/// Cells with 0 to `most` masks of K, in order along the cells; weights sum to 1.
inline compress::CellMasks hashedCells(std::size_t count, int masks, int most, std::uint64_t seed) {
  Hashed hashed(seed);
  compress::CellMasks cells{{0}, {}, {}};
  for (std::size_t p = 0; p < count; ++p) {
    const int active = hashed.below(std::min(most, masks) + 1);
    const int first = static_cast<int>(p * toSize(masks) / count);
    std::vector<double> weights;
    double sum = 0.0;
    for (int j = 0; j < active; ++j) sum += weights.emplace_back(hashed.unit() + 1e-3);
    for (int j = 0; j < active; ++j) {
      cells.mask_index.push_back((first + j) % masks);
      cells.mask_weights.push_back(static_cast<float>(weights[toSize(j)] / sum));
    }
    cells.cell_begin.push_back(static_cast<int>(cells.mask_index.size()));
  }
  return cells;
}

/// The texture of every expression under every mask, K x N.
inline std::vector<int> hashedTextures(int masks, int expressions, int clusters, std::uint64_t seed) {
  Hashed hashed(seed);
  std::vector<int> textures;
  for (int i = 0; i < masks * expressions; ++i) textures.push_back(hashed.below(clusters));
  return textures;
}

struct WeightMapSizes {
  std::size_t cells = 0;
  int expressions = 0;
  int masks = 0;
  int clusters = 4;
  int most_masks = 6;  ///< of a cell
};

/// The kernel alone. Must move: the masks of the cells once in, the bytes once out.
struct WeightMapProblem {
  WeightMapProblem(device::DeviceContext& device, const WeightMapSizes& problem_sizes)
      : context(device),
        sizes(problem_sizes),
        cells(hashedCells(sizes.cells, sizes.masks, sizes.most_masks, sizes.cells)),
        texture_of(hashedTextures(sizes.masks, sizes.expressions, sizes.clusters, 3)),
        weights(device, toSize(sizes.expressions, sizes.cells, sizes.clusters)),
        launch{.cells = sizes.cells,
               .expressions = sizes.expressions,
               .clusters = sizes.clusters,
               .first_entry = 0,
               .cell_begin = device.upload(cells.cell_begin, "cells"),
               .mask_index = device.upload(cells.mask_index, "masks"),
               .mask_weights = device.upload(cells.mask_weights, "weights"),
               .texture_of =
                   device.upload(compress::packTextureOf(texture_of, sizes.masks, sizes.expressions), "textures"),
               .weights = weights.buffer()} {}

  void run() {
    compress::launchWeightMap(context, launch);
    context.finish();
  }
  /// [expression][cell][texture]
  Layout<3> layout() const { return Layout(sizes.expressions, sizes.cells, sizes.clusters); }
  std::vector<std::uint8_t> result() const { return weights.read<std::uint8_t>(); }
  /// 255 W + 1/2, which rounds down to the byte.
  double expected(int n, std::size_t cell, int i) const {
    std::vector<std::pair<int, double>> active;
    for (int e = cells.cell_begin[cell]; e < cells.cell_begin[cell + 1]; ++e) {
      active.emplace_back(cells.mask_index[toSize(e)], static_cast<double>(cells.mask_weights[toSize(e)]));
    }
    std::vector<std::vector<int>> rows;
    for (std::size_t first = 0; first < texture_of.size(); first += toSize(sizes.expressions)) {
      const auto row = texture_of.begin() + static_cast<std::ptrdiff_t>(first);
      rows.emplace_back(row, row + sizes.expressions);
    }
    return 255.0 * reference::weight(active, rows, i, n) + 0.5;
  }

  double bytes() const {
    return static_cast<double>(layout().size() + 8 * cells.mask_index.size() + 4 * cells.cell_begin.size());
  }

  device::DeviceContext& context;
  WeightMapSizes sizes;
  compress::CellMasks cells;
  std::vector<int> texture_of;
  GuardedBuffer weights;
  compress::WeightMapLaunch launch;
};

}  // namespace facezip::test
