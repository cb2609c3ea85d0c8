#include "search/weight_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "cl/layout.h"
#include "io/counts.hpp"

namespace facezip::compress {
namespace {

// Expressions of a work-item in weight_map.cl.
constexpr int kLanes = FACEZIP_VECTOR;

int blocksOf(int expressions) { return divideUp(expressions, kLanes); }

}  // namespace

std::vector<int> packTextureOf(std::span<const int> texture_of, int masks, int expressions) {
  assert(texture_of.size() == toSize(masks, expressions));
  const auto row = toSize(blocksOf(expressions) * kLanes);
  std::vector<int> packed(toSize(masks) * row, -1);
  for (std::size_t k = 0; k < toSize(masks); ++k) {
    std::copy_n(texture_of.begin() + static_cast<std::ptrdiff_t>(k) * expressions, expressions,
                packed.begin() + static_cast<std::ptrdiff_t>(k * row));
  }
  return packed;
}

cl::Event launchWeightMap(device::DeviceContext& context, const WeightMapLaunch& launch) {
  const cl::Kernel kernel =
      context.kernel("weight_map.cl", "weight_map", fmt::format("-D CLUSTERS={}", launch.clusters));
  const std::size_t local = context.workGroupSize(kernel, 16);
  const std::size_t columns = roundUp(divideUp(launch.cells, FACEZIP_WEIGHT_MAP_CELLS), local);
  return context.launch(kernel, device::WorkItems(columns, blocksOf(launch.expressions)).inGroupsOf(local, 1),
                        launch.cell_begin, launch.mask_index, launch.mask_weights, launch.texture_of, launch.weights,
                        launch.cells, launch.expressions, launch.first_entry);
}

WeightMapper::WeightMapper(device::DeviceContext& context, std::span<const int> texture_of, int masks, int expressions,
                           int clusters)
    : context_(context),
      expressions_(expressions),
      clusters_(clusters),
      texture_of_(context.upload(packTextureOf(texture_of, masks, expressions), "textures of expressions")),
      cell_begin_(context, "cells of the weight maps", CL_MEM_READ_ONLY),
      mask_index_(context, "masks of the cells", CL_MEM_READ_ONLY),
      mask_weights_(context, "mask weights of the cells", CL_MEM_READ_ONLY),
      weights_(context, "weight maps", CL_MEM_WRITE_ONLY) {}

std::size_t WeightMapper::outputBytes(std::size_t cell_count) const {
  return cell_count * toSize(expressions_, clusters_);
}

void WeightMapper::fill(const CellMasks& cells, std::size_t first_cell, std::size_t cell_count,
                        std::span<std::uint8_t> out) {
  assert(first_cell + cell_count <= cells.cells() && out.size() == outputBytes(cell_count));
  if (out.empty()) return;
  const std::span<const int> begins = std::span(cells.cell_begin).subspan(first_cell, cell_count + 1);
  const auto first_entry = toSize(begins.front());
  const std::size_t entries = toSize(begins.back()) - first_entry;
  launchWeightMap(context_,
                  {.cells = cell_count,
                   .expressions = expressions_,
                   .clusters = clusters_,
                   .first_entry = begins.front(),
                   .cell_begin = cell_begin_.upload(begins),
                   .mask_index = mask_index_.upload(std::span(cells.mask_index).subspan(first_entry, entries)),
                   .mask_weights = mask_weights_.upload(std::span(cells.mask_weights).subspan(first_entry, entries)),
                   .texture_of = texture_of_,
                   .weights = weights_.reserve(out.size())});
  weights_.read(out);
}

void WeightMapper::fillAll(const CellMasks& cells, std::span<std::uint8_t> out) {
  constexpr std::size_t kCellsAtOnce = std::size_t{1} << 15;
  const std::size_t count = cells.cells();
  assert(out.size() == outputBytes(count));
  const auto channels = toSize(clusters_);
  std::vector<std::uint8_t> range;
  for (std::size_t first = 0; first < count; first += kCellsAtOnce) {
    const std::size_t in_range = std::min(kCellsAtOnce, count - first);
    range.resize(outputBytes(in_range));
    fill(cells, first, in_range, range);
    for (std::size_t n = 0; n < toSize(expressions_); ++n) {
      std::copy_n(range.data() + n * in_range * channels, in_range * channels,
                  out.data() + (n * count + first) * channels);
    }
  }
}

}  // namespace facezip::compress
