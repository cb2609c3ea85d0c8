// difference_texture.hpp - problem of the step `difference_texture`.
#pragma once

#include "problems/band.hpp"
#include "reference/difference_texture.hpp"
#include "search/difference_texture.hpp"

namespace facezip::test {

/// Every expression in one texture of each mask, with 1 / (size of the cluster).
inline compress::TextureCoefficients clusterCoefficients(int masks, int textures, int expressions) {
  Hashed hashed(21);
  compress::TextureCoefficients table{masks, textures, expressions, {}};
  const Layout places(masks, textures, expressions);
  table.values.assign(places.size(), 0.0f);
  for (int k = 0; k < masks; ++k) {
    std::vector<int> texture_of(toSize(expressions));
    std::vector<int> size(toSize(textures));
    for (int& texture : texture_of) {
      texture = hashed.below(textures);
      ++size[toSize(texture)];
    }
    for (int n = 0; n < expressions; ++n) {
      const int i = texture_of[toSize(n)];
      table.values[places(k, i, n)] = 1.0f / static_cast<float>(size[toSize(i)]);
    }
  }
  return table;
}

/// Must move: differences and masks once in, textures once out. Operations: a weight for each expression, mask and
/// texture, a product for each expression, texture and channel.
struct DifferenceTextureProblem : BandProblem {
  DifferenceTextureProblem(device::DeviceContext& device, const BandShape& band_shape, const TileMasks& tile_masks,
                           int mask_count, int texture_count,
                           device::KernelVariant variant = device::KernelVariant::kAuto)
      : BandProblem(device, band_shape, tile_masks),
        table(clusterCoefficients(mask_count, texture_count, shape.expressions)),
        textures(device, table, variant) {}

  int planes() const { return table.textures * shape.channels; }
  /// [tile][texture * channels + channel][256]
  Layout<3> textureLayout() const { return Layout(tileCount(), planes(), kTileTexels); }

  void run() {
    textures.compute(tiles, differences.buffer(), shape);
    context.finish();
  }
  std::vector<float> result() const {
    return context.download<float>(textures.textures(), textureLayout().size(), "difference textures");
  }
  std::vector<double> expected() const {
    std::vector<double> all;
    const auto per_tile = static_cast<std::ptrdiff_t>(shape.expressions * shape.channels * kTileTexels);
    for (std::size_t t = 0; t < tileCount(); ++t) {
      const auto first = delta().begin() + static_cast<std::ptrdiff_t>(t) * per_tile;
      std::vector<std::pair<int, std::vector<double>>> active;
      for (int e = masks.mask_begin[t]; e < masks.mask_begin[t + 1]; ++e) {
        const auto weights = masks.mask_weights.begin() + static_cast<std::ptrdiff_t>(e) * kTileTexels;
        active.push_back({masks.mask_index[toSize(e)], {weights, weights + kTileTexels}});
      }
      const std::vector<double> tile = reference::differenceTexture(
          active, table.values, table.textures, shape.expressions, shape.channels, {first, first + per_tile});
      all.insert(all.end(), tile.begin(), tile.end());
    }
    return all;
  }

  double textureBytes() const { return static_cast<double>(textureLayout().size() * sizeof(float)); }
  double bytes() const { return differenceBytes() + maskBytes() + textureBytes(); }
  double flops() const {
    const auto weights = static_cast<double>(masks.mask_weights.size());
    return 2.0 * table.textures * shape.expressions * (weights + texels() * shape.channels);
  }

  compress::TextureCoefficients table;
  compress::DifferenceTextures textures;
};

}  // namespace facezip::test
