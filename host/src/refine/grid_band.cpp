#include "refine/grid_band.hpp"

#include <fmt/format.h>

#include "bands/difference.hpp"

namespace facezip::compress {

std::string gridDefines(const BandShape& shape, const WeightSpace& space, int weight_scale) {
  return fmt::format("{} -D TEXTURES={} -D EXPRESSIONS={} -D EXPRESSION_LANES={} -D WEIGHT_SCALE={}",
                     differenceDefines(shape), space.textures, space.expressions, space.lanes(), weight_scale);
}

std::vector<int> tileLookup(const TileMasks& tiles, const BandShape& shape) {
  const Layout places(shape.tileRows(), shape.tileColumns());
  std::vector<int> lookup(places.size(), -1);
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    lookup[places(tiles.tiles[t].y, tiles.tiles[t].x)] = static_cast<int>(t);
  }
  return lookup;
}

}  // namespace facezip::compress
