// band_plan.hpp - how many rows a band has, so that the work stays within the memory it was given.
#pragma once

#include <cstdint>
#include <span>

#include "bands/map_set.hpp"
#include "bands/tile_band.hpp"
#include "facezip/device.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

/// What a band of a map keeps at once, per row of the image, on host and device together.
struct BandCost {
  std::uint64_t per_row = 0;
  std::uint64_t largest_buffer_per_row = 0;  ///< of the buffers on the device
  /// Bands beyond this gain nothing: launches are already cheap beside the work, and caches grow cold.
  std::uint64_t useful_bytes = 96u << 20;
  int row_step = 16;    ///< bands have a multiple of this many rows
  int rows_beside = 0;  ///< that are held with a band besides its own
};

/// shape       of the map; its rows are ignored; neutral_decoded where its textures are coded in blocks
/// textures    C
/// mask_count  K; a tile is taken to hold min(K, 16) of them, twice what 3 cm masks show on a head
BandCost bandCost(const BandShape& shape, int textures, int mask_count);

/// Rows of a band: a multiple of cost.row_step, at least that, at most what the whole image needs.
/// memory_bytes   what the process may keep resident in all
/// resident_bytes what it keeps beside the bands (weight maps, meshes; the libraries' own is added here)
/// Throws InputError if `memory_bytes` does not hold the smallest band, DeviceError if the device does not.
int planBandRows(const BandCost& cost, int height, std::uint64_t memory_bytes, std::uint64_t resident_bytes,
                 const DeviceInfo& device);

/// What windows of the refinement hold besides texels.
struct WindowForm {
  bool half_cells = false;  ///< whether the sweeps are made on half cells
  int block_rows = 0;       ///< where weights are fitted to coded textures, too: rows that their blocks fill
};

/// Rows of cells that a window of the refinement frees: a multiple of windowRowStep(maps), so that the windows of all
/// maps together stay within the memory. Arguments and errors as planBandRows() has them.
int planWindowRows(std::span<const GridMap> maps, const WeightSpace& space, const WindowForm& form,
                   std::uint64_t memory_bytes, std::uint64_t resident_bytes, const DeviceInfo& device);

}  // namespace facezip::compress
