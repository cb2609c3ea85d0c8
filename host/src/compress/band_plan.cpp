#include "compress/band_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bands/map_bands.hpp"
#include "refine/refinement.hpp"
#include "refine/weight_system.hpp"

namespace facezip::compress {
namespace {

constexpr std::uint64_t kMiB = 1u << 20;
/// What a process holds before the first texel: OpenCL's compiler, image libraries, the mesh and its factorisation; and
/// the Gram stage's partial sums. Measured with PoCL 3.1 (about 190 MiB) and rounded up.
constexpr std::uint64_t kProcessBytes = 256 * kMiB;
/// A window of the refinement also computes on the rows of tiles above and below it: larger ones have less of those.
constexpr std::uint64_t kUsefulWindowBytes = 192 * kMiB;
constexpr int kTypicalMasksPerTile = 16;

/// What a window of the refinement keeps of one map, per row of its image.
BandCost windowCost(const GridMap& map, const WeightSpace& space, bool in_blocks) {
  BandShape shape = bandShape(*map.map->samples, 0);
  shape.neutral_decoded = in_blocks;
  const auto tiles = static_cast<std::uint64_t>((shape.width + kTileSide - 1) / kTileSide);
  const std::uint64_t samples = tiles * kTileSide * static_cast<std::uint64_t>(shape.channels) *
                                (static_cast<std::uint64_t>(shape.expressions) + 1) *
                                static_cast<std::uint64_t>(image::sampleBytes(shape.sample_type));
  const std::uint64_t partial = tiles * systemBytesOfTile(space, map.weight_scale) / kTileSide;
  BandCost cost = bandCost(shape, space.textures, 1);
  // The samples are held once more while a window slides. The grid: equations, weights, start, and copies on the host.
  cost.per_row += samples + partial +
                  static_cast<std::uint64_t>(space.columns) * sizeof(float) *
                      (space.systemEntries() + 4 * space.cellFloats()) / static_cast<std::uint64_t>(map.weight_scale);
  cost.largest_buffer_per_row = std::max(cost.largest_buffer_per_row, partial);
  return cost;
}

std::string mebibytes(std::uint64_t bytes) { return fmt::format("{} MiB", (bytes + kMiB - 1) / kMiB); }

}  // namespace

BandCost bandCost(const BandShape& shape, int textures, int mask_count) {
  const auto texels = static_cast<std::uint64_t>((shape.width + kTileSide - 1) / kTileSide * kTileSide);
  const auto channels = static_cast<std::uint64_t>(shape.channels);
  const auto images = static_cast<std::uint64_t>(shape.expressions) + 1;
  const auto sample = static_cast<std::uint64_t>(image::sampleBytes(shape.sample_type));
  const std::uint64_t samples = texels * channels * images * sample;
  const std::uint64_t differences = texels * channels * (images - 1) * shape.differenceBytes();
  const std::uint64_t masks = texels * 4 * static_cast<std::uint64_t>(std::min(mask_count, kTypicalMasksPerTile) + 1);
  const std::uint64_t raster = texels * 16 * 2;
  const std::uint64_t outputs = texels * channels * static_cast<std::uint64_t>(textures) * (4 + 2);
  const std::uint64_t factors = shape.neutral_decoded
                                    ? texels * sizeof(float) *
                                          static_cast<std::uint64_t>(FACEZIP_FACTOR_PLANES(textures, shape.channels) +
                                                                     2 * shape.channels * (textures + 1))
                                    : 0;  // and codes, decoded textures; the decoded neutral on host and device
  BandCost cost;
  // Samples: one band being decoded, one at work, one on the device. Masks: on the host and on the device.
  cost.per_row = 3 * samples + differences + 2 * masks + raster + outputs + factors;
  cost.largest_buffer_per_row = std::max({samples, differences, masks, outputs, factors});
  return cost;
}

int planBandRows(const BandCost& cost, int height, std::uint64_t memory_bytes, std::uint64_t resident_bytes,
                 const DeviceInfo& device) {
  const auto step = static_cast<std::uint64_t>(cost.row_step);
  const auto rows_beside = static_cast<std::uint64_t>(cost.rows_beside);
  const std::uint64_t smallest_band = cost.per_row * step;
  const std::uint64_t beside = kProcessBytes + resident_bytes + cost.per_row * rows_beside;
  if (memory_bytes < beside + smallest_band) {
    throw InputError({"--memory", "", fmt::format("at least {} for this capture", mebibytes(beside + smallest_band)),
                      mebibytes(memory_bytes),
                      fmt::format("raise it, or compress fewer maps at a time{}",
                                  cost.row_step > kTileSide ? ", or take a --weight-scale of 4, 8, 16 or 32" : "")});
  }
  const std::uint64_t largest_buffer = cost.largest_buffer_per_row * (step + rows_beside);
  if (largest_buffer > device.largest_allocation_bytes || smallest_band > device.global_memory_bytes) {
    throw DeviceError(
        fmt::format("a band of {} rows", step), 0,
        fmt::format("needs {} in all and {} in one buffer; {} has {} and allows {}; choose another --device",
                    mebibytes(smallest_band), mebibytes(largest_buffer), device.name,
                    mebibytes(device.global_memory_bytes), mebibytes(device.largest_allocation_bytes)));
  }
  const std::uint64_t within_memory = (memory_bytes - beside) / cost.per_row;
  const std::uint64_t within_device =
      std::min(device.global_memory_bytes / 2 / cost.per_row,
               device.largest_allocation_bytes / cost.largest_buffer_per_row - rows_beside);
  const std::uint64_t rows = std::min({within_memory, within_device, cost.useful_bytes / cost.per_row});
  const auto needed = (static_cast<std::uint64_t>(height) + step - 1) / step * step;
  return static_cast<int>(std::clamp<std::uint64_t>(rows / step * step, step, needed));
}

int planWindowRows(std::span<const GridMap> maps, const WeightSpace& space, const WindowForm& form,
                   std::uint64_t memory_bytes, std::uint64_t resident_bytes, const DeviceInfo& device) {
  BandCost cost;  // per row of the finest map
  cost.useful_bytes = kUsefulWindowBytes;
  const GridMap& finest = *std::ranges::max_element(maps, {}, &GridMap::weight_scale);
  const auto finest_scale = static_cast<std::uint64_t>(finest.weight_scale);
  for (const GridMap& map : maps) {
    const BandCost one = windowCost(map, space, form.block_rows > 0);
    const auto scale = static_cast<std::uint64_t>(map.weight_scale);
    cost.per_row += one.per_row * scale / finest_scale;
    cost.largest_buffer_per_row =
        std::max(cost.largest_buffer_per_row, one.largest_buffer_per_row * scale / finest_scale);
  }
  if (form.half_cells) {
    const std::uint64_t bytes = HalfCells::bytesOfCellRow(space) / finest_scale;
    cost.per_row += bytes;
    cost.largest_buffer_per_row = std::max(cost.largest_buffer_per_row, bytes);
  }
  // Windows begin at whole tiles of every map and whole cells: 1008 rows for a scale of 63, where 64 has 64.
  cost.row_step = windowRowStep(maps) * finest.weight_scale;
  // Either end of a window reaches on to whole rows of blocks.
  cost.rows_beside = 2 * (windowHalo(finest.weight_scale) + form.block_rows);
  return planBandRows(cost, finest.map->samples->shape().height, memory_bytes, resident_bytes, device) /
         finest.weight_scale;
}

}  // namespace facezip::compress
