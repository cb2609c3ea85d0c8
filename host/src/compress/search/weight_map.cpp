#include "compress/search/weight_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace facezip::compress {
namespace {

// Expressions and cells of a work-item in weight_map.cl.
constexpr int kLanes = 16;
constexpr std::size_t kCells = 16;

int blocksOf(int expressions) { return (expressions + kLanes - 1) / kLanes; }

}  // namespace

std::vector<int> packTextureOf(std::span<const int> texture_of, int masks, int expressions) {
  assert(texture_of.size() == static_cast<std::size_t>(masks) * static_cast<std::size_t>(expressions));
  const auto row = static_cast<std::size_t>(blocksOf(expressions) * kLanes);
  std::vector<int> packed(static_cast<std::size_t>(masks) * row, -1);
  for (std::size_t k = 0; k < static_cast<std::size_t>(masks); ++k) {
    std::copy_n(texture_of.begin() + static_cast<std::ptrdiff_t>(k) * expressions, expressions,
                packed.begin() + static_cast<std::ptrdiff_t>(k * row));
  }
  return packed;
}

cl::Event launchWeightMap(device::DeviceContext& context, const WeightMapLaunch& launch) {
  cl::Kernel kernel = context.kernel("weight_map.cl", "weight_map", fmt::format("-D CLUSTERS={}", launch.clusters));
  kernel.setArg(0, launch.cell_begin);
  kernel.setArg(1, launch.mask_index);
  kernel.setArg(2, launch.mask_weights);
  kernel.setArg(3, launch.texture_of);
  kernel.setArg(4, launch.weights);
  kernel.setArg(5, static_cast<cl_ulong>(launch.cells));
  kernel.setArg(6, static_cast<cl_int>(launch.expressions));
  kernel.setArg(7, static_cast<cl_int>(launch.first_entry));
  const std::size_t local = context.workGroupSize(kernel, 16);
  const std::size_t columns = device::roundUp((launch.cells + kCells - 1) / kCells, local);
  return context.run(kernel, cl::NDRange(columns, static_cast<std::size_t>(blocksOf(launch.expressions))),
                     cl::NDRange(local, 1));
}

WeightMapper::WeightMapper(device::DeviceContext& context, std::span<const int> texture_of, int masks, int expressions,
                           int clusters)
    : context_(context),
      expressions_(expressions),
      clusters_(clusters),
      texture_of_(context.upload(packTextureOf(texture_of, masks, expressions), "textures of expressions")) {}

std::size_t WeightMapper::outputBytes(std::size_t cell_count) const {
  return cell_count * static_cast<std::size_t>(expressions_) * static_cast<std::size_t>(clusters_);
}

cl::Buffer& WeightMapper::pooled(cl::Buffer& buffer, std::size_t& capacity, std::size_t bytes, const char* what) {
  if (bytes > capacity || capacity == 0) {
    buffer = cl::Buffer();  // first give back, then take: a band may be near all the memory there is
    capacity = 0;
    buffer = context_.allocate(bytes, CL_MEM_READ_WRITE, what);
    capacity = std::max<std::size_t>(bytes, 1);
  }
  return buffer;
}

void WeightMapper::fill(const CellMasks& cells, std::size_t first_cell, std::size_t cell_count,
                        std::span<std::uint8_t> out) {
  assert(first_cell + cell_count <= cells.cells() && out.size() == outputBytes(cell_count));
  if (out.empty()) return;
  const std::span<const int> begins = std::span(cells.cell_begin).subspan(first_cell, cell_count + 1);
  const auto first_entry = static_cast<std::size_t>(begins.front());
  const std::size_t entries = static_cast<std::size_t>(begins.back()) - first_entry;
  const auto masks = std::span(cells.mask_index).subspan(first_entry, entries);
  const auto mask_weights = std::span(cells.mask_weights).subspan(first_entry, entries);

  pooled(cell_begin_, cell_begin_capacity_, begins.size_bytes(), "cells of the weight maps");
  pooled(mask_index_, mask_index_capacity_, masks.size_bytes(), "masks of the cells");
  pooled(mask_weights_, mask_weights_capacity_, mask_weights.size_bytes(), "mask weights of the cells");
  pooled(weights_, weights_capacity_, out.size(), "weight maps");
  context_.write(cell_begin_, begins.data(), begins.size_bytes(), "cells of the weight maps");
  context_.write(mask_index_, masks.data(), masks.size_bytes(), "masks of the cells");
  context_.write(mask_weights_, mask_weights.data(), mask_weights.size_bytes(), "mask weights of the cells");
  launchWeightMap(context_, {.cells = cell_count,
                             .expressions = expressions_,
                             .clusters = clusters_,
                             .first_entry = begins.front(),
                             .cell_begin = cell_begin_,
                             .mask_index = mask_index_,
                             .mask_weights = mask_weights_,
                             .texture_of = texture_of_,
                             .weights = weights_});
  context_.read(weights_, out.data(), out.size(), "weight maps");
}

void WeightMapper::fillAll(const CellMasks& cells, std::span<std::uint8_t> out) {
  constexpr std::size_t kCellsAtOnce = std::size_t{1} << 15;
  const std::size_t count = cells.cells();
  assert(out.size() == outputBytes(count));
  const auto channels = static_cast<std::size_t>(clusters_);
  std::vector<std::uint8_t> range;
  for (std::size_t first = 0; first < count; first += kCellsAtOnce) {
    const std::size_t in_range = std::min(kCellsAtOnce, count - first);
    range.resize(outputBytes(in_range));
    fill(cells, first, in_range, range);
    for (std::size_t n = 0; n < static_cast<std::size_t>(expressions_); ++n) {
      std::copy_n(range.data() + n * in_range * channels, in_range * channels,
                  out.data() + (n * count + first) * channels);
    }
  }
}

}  // namespace facezip::compress
