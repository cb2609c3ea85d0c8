#include "codes/tile_rows.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

/// Calls copy(place in rows, place in tiles) for every sample of every tile that lies in the band.
template <typename Copy>
void forEachSample(std::span<const TilePosition> positions, const BandShape& shape, const Copy& copy) {
  const auto channels = toSize(shape.channels);
  tbb::parallel_for(std::size_t{0}, positions.size(), [&](std::size_t t) {
    const int x0 = positions[t].x * kTileSide;
    const int y0 = positions[t].y * kTileSide;
    const int columns = std::min(kTileSide, shape.width - x0);
    for (int y = 0; y < std::min(kTileSide, shape.rows - y0); ++y) {
      const std::size_t row = toSize(y0 + y, shape.width) + toSize(x0);
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t tile = (t * channels + c) * kTileTexels + toSize(y * kTileSide);
        for (std::size_t x = 0; x < toSize(columns); ++x) copy((row + x) * channels + c, tile + x);
      }
    }
  });
}

}  // namespace

void tilesToRows(std::span<const TilePosition> positions, const BandShape& shape, std::span<const float> tiles,
                 std::span<float> rows) {
  assert(rows.size() == toSize(shape.rows, shape.width, shape.channels));
  forEachSample(positions, shape, [&](std::size_t row, std::size_t tile) { rows[row] = tiles[tile]; });
}

void rowsToTiles(std::span<const TilePosition> positions, const BandShape& shape, std::span<const float> rows,
                 std::span<float> tiles) {
  assert(rows.size() == toSize(shape.rows, shape.width, shape.channels));
  forEachSample(positions, shape, [&](std::size_t row, std::size_t tile) { tiles[tile] = rows[row]; });
}

}  // namespace facezip::compress
