// tile_rows.hpp - one texture, between the tiles that kernels fit and the rows that encoders of pictures take.
#pragma once

#include <span>

#include "bands/tile_band.hpp"

namespace facezip::compress {

/// tiles   [tile][channel][256]
/// rows    shape.rows x shape.width x shape.channels; texels of no tile are left alone
void tilesToRows(std::span<const TilePosition> positions, const BandShape& shape, std::span<const float> tiles,
                 std::span<float> rows);
/// The way back. Texels of tiles that hang over the band are left alone.
void rowsToTiles(std::span<const TilePosition> positions, const BandShape& shape, std::span<const float> rows,
                 std::span<float> tiles);

}  // namespace facezip::compress
