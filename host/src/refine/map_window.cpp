#include "refine/map_window.hpp"

#include <algorithm>

#include "bands/difference.hpp"
#include "bands/map_bands.hpp"

namespace facezip::compress {

MapWindow::MapWindow(device::DeviceContext& context, const GridMap& map, int row_step)
    : context_(context),
      map_(map),
      row_step_(row_step),
      window_(*map.map->samples),
      tiles_(context),
      samples_(context, "samples of a band", CL_MEM_READ_ONLY),
      neutral_(context, "decoded neutral of a band", CL_MEM_READ_ONLY),
      differences_(context, "differences of a band"),
      tile_at_(context, "lookup of tiles", CL_MEM_READ_ONLY) {}

void MapWindow::prepare(int free_begin, int free_end, const MakeMapTiles& make_tiles) {
  const int height = map_.map->samples->shape().height;
  const int halo = windowHalo(map_.weight_scale);
  own_begin_ = std::min(free_begin * map_.weight_scale, height);
  own_end_ = std::min(free_end * map_.weight_scale, height);
  window_.moveTo(std::max(0, own_begin_ - halo) / row_step_ * row_step_,
                 std::min(height, roundUp(own_end_ + halo, row_step_)));
  masks_ = make_tiles(*map_.map, window_.begin(), window_.end());
}

void MapWindow::load(std::span<const float> neutral) {
  shape_ = bandShape(*map_.map->samples, window_.end() - window_.begin());
  shape_.neutral_decoded = !neutral.empty();
  first_row_ = window_.begin();
  const auto first_behind = [&](int row) {
    return static_cast<std::size_t>(
        std::partition_point(masks_.tiles.begin(), masks_.tiles.end(),
                             [&](const TilePosition& tile) { return first_row_ + tile.y * kTileSide < row; }) -
        masks_.tiles.begin());
  };
  first_own_tile_ = first_behind(own_begin_);
  end_of_own_tiles_ = first_behind(own_end_);
  tiles_.upload(masks_);
  tile_at_.upload(tileLookup(masks_, shape_));
  const cl::Buffer& raw = samples_.upload(window_.samples());
  differences_.reserve(differenceBufferBytes(shape_, masks_.tiles.size()));
  if (neutral.empty()) {
    computeDifferences(context_, tiles_, shape_, raw, differences_.buffer());
  } else {
    computeDifferences(context_, tiles_, shape_, raw, neutral_.upload(neutral), differences_.buffer());
  }
}

raster::CellRows MapWindow::cellRows(int grid_rows) const {
  return cellRowsOf(window_.begin(), window_.end(), map_.weight_scale, grid_rows);
}

int windowHalo(int weight_scale) { return roundUp((weight_scale + 1) / 2, kTileSide); }

}  // namespace facezip::compress
