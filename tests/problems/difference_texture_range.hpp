// difference_texture_range.hpp - problem of the step `difference_texture_range`.
#pragma once

#include "problems/difference_texture.hpp"
#include "reference/difference_texture_range.hpp"
#include "refine/difference_texture_range.hpp"

namespace facezip::test {

/// Must move: masks and textures once in.
struct DifferenceTextureRangeProblem : DifferenceTextureProblem {
  DifferenceTextureRangeProblem(device::DeviceContext& device, const BandShape& band_shape, const TileMasks& tile_masks,
                                int mask_count, int texture_count)
      : DifferenceTextureProblem(device, band_shape, tile_masks, mask_count, texture_count),
        finder(device, texture_count) {
    DifferenceTextureProblem::run();
  }

  void run() { ranges = finder.findPerTile(tiles, shape, textures.textures(), 0, tileCount()); }
  /// [tile][plane]
  const std::vector<compress::TextureRange>& result() const { return ranges; }
  std::vector<std::pair<float, float>> expected() const {
    const std::vector<float> values = DifferenceTextureProblem::result();
    std::vector<std::pair<float, float>> all;
    for (std::size_t t = 0; t < tileCount(); ++t) {
      const auto masks_of_tile = [&](int e) { return masks.mask_weights.data() + toSize(e, kTileTexels); };
      std::vector<const float*> active;
      for (int e = masks.mask_begin[t]; e < masks.mask_begin[t + 1]; ++e) active.push_back(masks_of_tile(e));
      for (int plane = 0; plane < planes(); ++plane) {
        all.push_back(reference::rangeUnderMasks(values.data() + textureLayout()(t, plane, 0), active));
      }
    }
    return all;
  }

  double bytes() const { return maskBytes() + textureBytes(); }

  compress::TextureRangeFinder finder;
  std::vector<compress::TextureRange> ranges;
};

}  // namespace facezip::test
