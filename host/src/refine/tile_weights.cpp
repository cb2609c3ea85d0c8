#include "refine/tile_weights.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace facezip::compress {
namespace {

/// Of every cell: [row][column][C].
std::vector<float> largestOfCells(const WeightSpace& space, std::span<const float> weights) {
  std::vector<float> largest(weights.size() / space.lanes());
  tbb::parallel_for(std::size_t{0}, largest.size(), [&](std::size_t i) {
    for (const float weight : weights.subspan(i * space.lanes(), space.lanes())) {
      largest[i] = std::max(largest[i], std::abs(weight));
    }
  });
  return largest;
}

}  // namespace

std::vector<float> largestWeights(std::span<const raster::TilePosition> tiles, int first_row, int scale,
                                  const WeightSpace& space, const raster::CellRows& rows,
                                  std::span<const float> weights) {
  const std::vector<float> of_cells = largestOfCells(space, weights);
  const std::size_t textures = toSize(space.textures);
  const Layout cell(rows.end - rows.begin, space.columns, space.textures);
  std::vector<float> largest(tiles.size() * textures, 0.0f);
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    const int y = first_row + tiles[t].y * raster::kTileSide;
    const int x = tiles[t].x * raster::kTileSide;
    const raster::CellRows down = raster::cellRowsOf(y, y + raster::kTileSide, scale, space.rows);
    const raster::CellRows across = raster::cellRowsOf(x, x + raster::kTileSide, scale, space.columns);
    for (int row = std::max(down.begin, rows.begin); row < std::min(down.end, rows.end); ++row) {
      for (int column = across.begin; column < across.end; ++column) {
        for (int i = 0; i < space.textures; ++i) {
          float& of_tile = largest[t * textures + toSize(i)];
          of_tile = std::max(of_tile, of_cells[cell(row - rows.begin, column, i)]);
        }
      }
    }
  });
  return largest;
}

}  // namespace facezip::compress
