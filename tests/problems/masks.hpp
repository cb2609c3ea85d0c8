// masks.hpp - masks of the tiles of a band: awkward ones to find faults with, and those of a face's shape.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "bands/tile_band.hpp"
#include "problems/hashed.hpp"
#include "search/gram_matrices.hpp"

namespace facezip::test {

using compress::BandShape;
using compress::kTileSide;
using compress::kTileTexels;
using compress::TileMasks;

/// Masks on most tiles of the band, each texel either 0 or in (0, 1], summing to at most 1. The numbers of masks of the
/// tiles run through 0 .. most_masks; a tile in eight is left out; a texel in four is gutter (texel weight 0).
inline TileMasks scatteredMasks(const BandShape& shape, int mask_count, int most_masks, std::uint64_t seed) {
  Hashed hashed(seed);
  TileMasks masks;
  masks.mask_begin.push_back(0);
  int turn = 0;
  for (int y = 0; y < shape.tileRows(); ++y) {
    for (int x = 0; x < shape.tileColumns(); ++x) {
      if (hashed.oneIn(8)) continue;
      masks.tiles.push_back({x, y});
      std::vector<int> active;
      const int wanted = std::min(turn++ % (most_masks + 1), mask_count);
      while (static_cast<int>(active.size()) < wanted) {
        const int k = hashed.below(mask_count);
        if (std::find(active.begin(), active.end(), k) == active.end()) active.push_back(k);
      }
      std::sort(active.begin(), active.end());
      for (const int k : active) {
        masks.mask_index.push_back(k);
        for (int t = 0; t < kTileTexels; ++t) {
          const bool off = hashed.oneIn(3);
          masks.mask_weights.push_back(off ? 0.0f : static_cast<float>(hashed.unit()) / static_cast<float>(wanted));
        }
      }
      masks.mask_begin.push_back(static_cast<int>(masks.mask_index.size()));
      for (int t = 0; t < kTileTexels; ++t) {
        const bool inside = x * kTileSide + t % kTileSide < shape.width && y * kTileSide + t / kTileSide < shape.rows;
        masks.texel_weights.push_back(inside && !hashed.oneIn(4) ? 1.0f : 0.0f);
      }
    }
  }
  return masks;
}

/// Tiles as steps get them that want no masks: one for each, 1 where a texture is wanted and 0 at half of the gutter.
/// Texel weights lie between 0 and 1, as importance makes them.
inline TileMasks scatteredTexels(const BandShape& shape, std::uint64_t seed) {
  TileMasks tiles = scatteredMasks(shape, 1, 1, seed);
  Hashed hashed(seed + 1);
  tiles.mask_weights.clear();
  tiles.mask_index.assign(tiles.tiles.size(), 0);
  tiles.mask_begin.clear();
  for (std::size_t t = 0; t <= tiles.tiles.size(); ++t) tiles.mask_begin.push_back(static_cast<int>(t));
  for (float& weight : tiles.texel_weights) {
    if (weight > 0.0f) weight = hashed.between(0.25f, 1.0f);
    tiles.mask_weights.push_back(weight > 0.0f || hashed.oneIn(2) ? 1.0f : 0.0f);
  }
  return tiles;
}

/// `mask_count` smooth bumps on a jittered grid over a square of `resolution` texels, normalised to sum to 1. Their
/// radius makes about eight of them overlap in a tile, as the masks of a face with 53 samples do. All texels are
/// covered.
inline TileMasks bumpMasks(int resolution, int mask_count) {
  constexpr double kOverlap = 9.0;  // bumps over a texel far from the border; a tile of the whole image meets eight
  struct Bump {
    double x, y;
    double at(int texel_x, int texel_y, double radius) const {
      const double squared = ((texel_x - x) * (texel_x - x) + (texel_y - y) * (texel_y - y)) / (radius * radius);
      return squared < 1.0 ? (1.0 - squared) * (1.0 - squared) : 0.0;
    }
  };
  const double radius = resolution * std::sqrt(kOverlap / (mask_count * std::numbers::pi));
  const int side = static_cast<int>(std::ceil(std::sqrt(mask_count)));
  Hashed hashed(1);
  std::vector<Bump> bumps;
  for (int k = 0; k < mask_count; ++k) {
    // Cells are dealt out evenly, so that a count that is no square still covers the image.
    const int cell = k * side * side / mask_count;
    const double x = cell % side + 0.25 + 0.5 * hashed.unit();
    const double y = cell / side + 0.25 + 0.5 * hashed.unit();
    bumps.push_back({x * resolution / side, y * resolution / side});
  }
  TileMasks masks;
  masks.mask_begin.push_back(0);
  const int tiles = compress::tilesAlong(resolution);
  for (int tile = 0; tile < tiles * tiles; ++tile) {
    masks.tiles.push_back({tile % tiles, tile / tiles});
    std::array<double, kTileTexels> sum{};
    std::vector<std::array<double, kTileTexels>> active;
    for (int k = 0; k < mask_count; ++k) {
      std::array<double, kTileTexels> values{};
      for (std::size_t t = 0; t < kTileTexels; ++t) {
        const int in_tile = static_cast<int>(t);
        values[t] = bumps[toSize(k)].at(tile % tiles * kTileSide + in_tile % kTileSide,
                                        tile / tiles * kTileSide + in_tile / kTileSide, radius);
        sum[t] += values[t];
      }
      if (std::ranges::all_of(values, [](double value) { return value == 0.0; })) continue;
      masks.mask_index.push_back(k);
      active.push_back(values);
    }
    for (const auto& values : active) {
      for (std::size_t t = 0; t < kTileTexels; ++t) {
        masks.mask_weights.push_back(sum[t] > 0.0 ? static_cast<float>(values[t] / sum[t]) : 0.0f);
      }
    }
    masks.mask_begin.push_back(static_cast<int>(masks.mask_index.size()));
    masks.texel_weights.insert(masks.texel_weights.end(), kTileTexels, 1.0f);
  }
  return masks;
}

/// Every tile of the band, each texel covered and wanted.
inline TileMasks wholeBand(const BandShape& shape) {
  TileMasks masks;
  masks.mask_begin.push_back(0);
  for (int y = 0; y < shape.tileRows(); ++y) {
    for (int x = 0; x < shape.tileColumns(); ++x) {
      masks.tiles.push_back({x, y});
      masks.mask_index.push_back(0);
      masks.mask_begin.push_back(static_cast<int>(masks.mask_index.size()));
      masks.mask_weights.insert(masks.mask_weights.end(), kTileTexels, 1.0f);
      masks.texel_weights.insert(masks.texel_weights.end(), kTileTexels, 1.0f);
    }
  }
  return masks;
}

/// Every mask, and every pair that shares a tile.
inline compress::GramSlots slotsOf(const std::vector<const TileMasks*>& bands, int mask_count) {
  std::set<std::pair<int, int>> pairs;
  for (const TileMasks* masks : bands) {
    for (std::size_t t = 0; t < masks->tiles.size(); ++t) {
      for (int a = masks->mask_begin[t]; a < masks->mask_begin[t + 1]; ++a) {
        for (int b = a + 1; b < masks->mask_begin[t + 1]; ++b) {
          pairs.insert({masks->mask_index[toSize(a)], masks->mask_index[toSize(b)]});
        }
      }
    }
  }
  compress::GramSlots slots{mask_count, {}};
  for (const auto& [k, l] : pairs) slots.pairs.push_back({k, l});
  return slots;
}

}  // namespace facezip::test
