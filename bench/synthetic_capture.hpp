// synthetic_capture.hpp - generated input for the benchmarks: nothing on disk, the same on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compress/bands/tile_band.hpp"
#include "compress/search/gram_matrices.hpp"

namespace facezip::bench {

/// Samples of a band, hashed from their position.
std::vector<std::byte> makeSamples(const compress::BandShape& shape);

/// `mask_count` smooth bumps on a jittered grid over a square of `resolution` texels, normalised to sum to 1. Their
/// radius makes about eight of them overlap in a tile, as the masks of a face with 53 samples do. All texels are
/// covered.
compress::TileMasks makeBumpMasks(int resolution, int mask_count);

/// Every mask, and every pair that shares a tile.
compress::GramSlots slotsOf(const compress::TileMasks& masks, int mask_count);

}  // namespace facezip::bench
