// map_window.hpp - the texels of one map that a window of the refinement sees, on the device.
#pragma once

#include <functional>
#include <span>

#include "bands/device_tiles.hpp"
#include "bands/map_set.hpp"
#include "device/pooled_buffer.hpp"
#include "image/sample_window.hpp"
#include "refine/grid_band.hpp"

namespace facezip::compress {

/// Tiles of rows [begin, end) of a map, one mask each: raster::activeTiles().
using MakeMapTiles = std::function<TileMasks(const OpenMap& map, int begin, int end)>;

class MapWindow {
 public:
  /// row_step  rows of texels that windows begin at multiples of, and end at, but for the last; textures that are coded
  ///           in blocks want whole ones
  MapWindow(device::DeviceContext& context, const GridMap& map, int row_step = 1);

  const GridMap& map() const { return map_; }

  /// Reads the texels that rows [free_begin, free_end) of cells reach into host memory. May run beside the device's
  /// work on the window before. Throws InputError, OutputError.
  void prepare(int free_begin, int free_end, const MakeMapTiles& make_tiles);
  /// Rows of texels that are prepared.
  int begin() const { return window_.begin(); }
  int end() const { return window_.end(); }
  const TileMasks& masks() const { return masks_; }

  /// Puts what was prepared on the device.
  /// neutral  what a coded neutral decodes to in rows [begin, end), in units of 1/255; empty: the captured one
  void load(std::span<const float> neutral = {});

  /// What load() put there. The window must outlive it.
  GridBand band() const { return {tiles_, shape_, differences_.buffer(), first_row_, map_.weight_scale}; }
  const cl::Buffer& tileAt() const { return tile_at_.buffer(); }
  /// Cells that the texels interpolate between.
  raster::CellRows cellRows(int grid_rows) const;
  /// Tiles of the free rows themselves.
  std::size_t firstOwnTile() const { return first_own_tile_; }
  std::size_t endOfOwnTiles() const { return end_of_own_tiles_; }

 private:
  device::DeviceContext& context_;
  GridMap map_;
  int row_step_;
  // What prepare() makes.
  image::SampleWindow window_;
  TileMasks masks_;
  int own_begin_ = 0;  ///< texel rows of the free cells
  int own_end_ = 0;
  // What is on the device.
  BandShape shape_;
  int first_row_ = 0;
  DeviceTiles tiles_;
  device::PooledBuffer samples_;
  device::PooledBuffer neutral_;
  device::PooledBuffer differences_;
  device::PooledBuffer tile_at_;
  std::size_t first_own_tile_ = 0;
  std::size_t end_of_own_tiles_ = 0;
};

/// Texel rows beside a window's own that its cells reach into, a multiple of 16.
int windowHalo(int weight_scale);

}  // namespace facezip::compress
