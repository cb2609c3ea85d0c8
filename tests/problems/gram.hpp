// gram.hpp - problem of the step `gram`.
#pragma once

#include "problems/band.hpp"
#include "reference/gram.hpp"
#include "search/gram.hpp"

namespace facezip::test {

/// The tiles of a band for the reference.
inline std::vector<reference::GramTile> gramTiles(const BandProblem& band) {
  const std::vector<double>& delta = band.delta();
  const Layout<4> places = band.deltaLayout();
  std::vector<reference::GramTile> tiles(band.tileCount());
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const auto first = delta.begin() + static_cast<std::ptrdiff_t>(places(t, 0, 0, 0));
    tiles[t].differences.assign(first, first + band.shape.expressions * band.shape.channels * kTileTexels);
    const auto texels = band.masks.texel_weights.begin() + static_cast<std::ptrdiff_t>(t * kTileTexels);
    tiles[t].texel_weights.assign(texels, texels + kTileTexels);
    for (int e = band.masks.mask_begin[t]; e < band.masks.mask_begin[t + 1]; ++e) {
      const auto weights = band.masks.mask_weights.begin() + static_cast<std::ptrdiff_t>(e) * kTileTexels;
      tiles[t].masks.push_back({band.masks.mask_index[toSize(e)], {weights, weights + kTileTexels}});
    }
  }
  return tiles;
}

/// All that GramAccumulator::add() does: plan, kernels, reduction, sums in double. Operations: for every two
/// expressions a product per channel, and a weighted sum per slot of the tile.
struct GramProblem : BandProblem {
  GramProblem(device::DeviceContext& device, const BandShape& band_shape, const TileMasks& tile_masks, int mask_count,
              device::KernelVariant variant = device::KernelVariant::kAuto,
              std::size_t largest_partial_bytes = compress::GramAccumulator::kLargestPartialBytes)
      : BandProblem(device, band_shape, tile_masks),
        slots(slotsOf({&masks}, mask_count)),
        accumulator(device, slots, shape.expressions, variant, largest_partial_bytes) {}

  void run() { accumulator.add(tiles, differences.buffer(), shape, metric_weight); }
  compress::GramMatrices result() { return accumulator.finish(); }
  /// Of masks k and l; -1 for none. N x N.
  std::vector<double> expected(int k, int l) const {
    std::vector<double> gram = reference::gram(gramTiles(*this), shape.expressions, shape.channels, k, l);
    for (double& value : gram) value *= metric_weight;
    return gram;
  }

  double flops() const {
    double per_pair = 0.0;
    for (std::size_t t = 0; t < tileCount(); ++t) {
      const auto active = static_cast<double>(tiles.masksOf(t).size());
      per_pair += kTileTexels * (shape.channels + 1.0 + active + active * (active - 1.0) / 2.0);
    }
    return 2.0 * per_pair * shape.expressions * (shape.expressions + 1.0) / 2.0;
  }

  double metric_weight = 0.75;
  compress::GramSlots slots;
  compress::GramAccumulator accumulator;
};

}  // namespace facezip::test
