#include "synthetic_capture.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace facezip::bench {
namespace {

using compress::kTileSide;
using compress::kTileTexels;

/// SplitMix64: good bits from a counter.
std::uint64_t hash(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

double unitHash(std::uint64_t x) { return static_cast<double>(hash(x) >> 11) * 0x1.0p-53; }

struct Bump {
  double x = 0.0;
  double y = 0.0;
};

std::vector<Bump> makeBumps(int resolution, int mask_count) {
  const int side = static_cast<int>(std::ceil(std::sqrt(mask_count)));
  std::vector<Bump> bumps;
  for (int k = 0; k < mask_count; ++k) {
    // Cells are dealt out evenly, so that a count that is no square still covers the image.
    const int cell = k * side * side / mask_count;
    const double x = cell % side + 0.25 + 0.5 * unitHash(2 * static_cast<std::uint64_t>(k));
    const double y = cell / side + 0.25 + 0.5 * unitHash(2 * static_cast<std::uint64_t>(k) + 1);
    bumps.push_back({x * resolution / side, y * resolution / side});
  }
  return bumps;
}

double bumpAt(const Bump& bump, double x, double y, double radius) {
  const double squared = ((x - bump.x) * (x - bump.x) + (y - bump.y) * (y - bump.y)) / (radius * radius);
  return squared < 1.0 ? (1.0 - squared) * (1.0 - squared) : 0.0;
}

void appendTile(const std::vector<Bump>& bumps, double radius, int tile_x, int tile_y, compress::TileMasks& masks) {
  std::array<double, kTileTexels> sum{};
  std::vector<std::pair<int, std::array<double, kTileTexels>>> active;
  for (std::size_t k = 0; k < bumps.size(); ++k) {
    std::array<double, kTileTexels> values{};
    bool any = false;
    for (int t = 0; t < kTileTexels; ++t) {
      const auto p = static_cast<std::size_t>(t);
      values[p] = bumpAt(bumps[k], tile_x * kTileSide + t % kTileSide, tile_y * kTileSide + t / kTileSide, radius);
      sum[p] += values[p];
      any = any || values[p] > 0.0;
    }
    if (any) active.emplace_back(static_cast<int>(k), values);
  }
  masks.tiles.push_back({tile_x, tile_y});
  for (const auto& [k, values] : active) {
    masks.mask_index.push_back(k);
    for (std::size_t p = 0; p < kTileTexels; ++p) {
      masks.mask_weights.push_back(sum[p] > 0.0 ? static_cast<float>(values[p] / sum[p]) : 0.0f);
    }
  }
  masks.mask_begin.push_back(static_cast<int>(masks.mask_index.size()));
  masks.texel_weights.insert(masks.texel_weights.end(), kTileTexels, 1.0f);
}

}  // namespace

std::vector<std::byte> makeSamples(const compress::BandShape& shape) {
  std::vector<std::byte> samples(shape.sampleBytes());
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::byte>(hash(i) & 0xff);
  return samples;
}

compress::TileMasks makeBumpMasks(int resolution, int mask_count) {
  const double overlap = 9.0;  // bumps over a texel far from the border; a tile of the whole image meets eight or so
  const double radius = resolution * std::sqrt(overlap / (mask_count * std::numbers::pi));
  const std::vector<Bump> bumps = makeBumps(resolution, mask_count);
  compress::TileMasks masks;
  masks.mask_begin.push_back(0);
  for (int y = 0; y * kTileSide < resolution; ++y) {
    for (int x = 0; x * kTileSide < resolution; ++x) appendTile(bumps, radius, x, y, masks);
  }
  return masks;
}

compress::GramSlots slotsOf(const compress::TileMasks& masks, int mask_count) {
  std::set<std::pair<int, int>> pairs;
  for (std::size_t t = 0; t < masks.tiles.size(); ++t) {
    for (int a = masks.mask_begin[t]; a < masks.mask_begin[t + 1]; ++a) {
      for (int b = a + 1; b < masks.mask_begin[t + 1]; ++b) {
        pairs.insert({masks.mask_index[static_cast<std::size_t>(a)], masks.mask_index[static_cast<std::size_t>(b)]});
      }
    }
  }
  compress::GramSlots slots{mask_count, {}};
  for (const auto& [k, l] : pairs) slots.pairs.push_back({k, l});
  return slots;
}

}  // namespace facezip::bench
