// synthetic_band.hpp - random bands for the tests of the texel-sized kernels.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "compress/bands/tile_band.hpp"

namespace facezip::test {

/// Uniform in [0, 1), the same on every platform (std::uniform_real_distribution is not).
inline double unitRandom(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1.0p-53; }
inline int intRandom(std::mt19937_64& random, int end) {
  return static_cast<int>(random() % static_cast<unsigned>(end));
}

/// A band with its raw samples, as bytes for the device and as doubles for the references.
struct SyntheticBand {
  compress::BandShape shape;
  std::vector<std::byte> samples;
  std::vector<double> values;  ///< the same samples
};

inline SyntheticBand makeBand(const compress::BandShape& shape, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  SyntheticBand band{shape, std::vector<std::byte>(shape.sampleBytes()), {}};
  const std::size_t size = image::sampleBytes(shape.sample_type);
  const std::size_t count = shape.sampleBytes() / size;
  const auto put = [&](std::size_t i, auto value) {
    std::memcpy(band.samples.data() + i * size, &value, size);
    band.values.push_back(static_cast<double>(value));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const double u = unitRandom(random);
    if (shape.sample_type == image::SampleType::kUint8) put(i, static_cast<std::uint8_t>(u * 256.0));
    if (shape.sample_type == image::SampleType::kUint16) put(i, static_cast<std::uint16_t>(u * 65536.0));
    if (shape.sample_type == image::SampleType::kFloat32) put(i, static_cast<float>(u * 2.0 - 0.5));
  }
  return band;
}

/// Random masks (each texel either 0 or in (0, 1], summing to at most 1) on most tiles of the band. The numbers of
/// masks of the tiles run through 0..most_masks; a tile in eight is left out; a texel in four is gutter (texel weight
/// 0).
inline compress::TileMasks makeTileMasks(const compress::BandShape& shape, int mask_count, int most_masks,
                                         std::uint64_t seed) {
  std::mt19937_64 random(seed);
  compress::TileMasks masks;
  masks.mask_begin.push_back(0);
  int turn = 0;
  for (int y = 0; y * compress::kTileSide < shape.rows; ++y) {
    for (int x = 0; x * compress::kTileSide < shape.width; ++x) {
      if (random() % 8 == 0) continue;
      masks.tiles.push_back({x, y});
      std::vector<int> active;
      const int wanted = std::min(turn++ % (most_masks + 1), mask_count);
      while (static_cast<int>(active.size()) < wanted) {
        const int k = intRandom(random, mask_count);
        if (std::find(active.begin(), active.end(), k) == active.end()) active.push_back(k);
      }
      std::sort(active.begin(), active.end());
      for (const int k : active) {
        masks.mask_index.push_back(k);
        for (int t = 0; t < compress::kTileTexels; ++t) {
          const bool off = random() % 3 == 0;
          masks.mask_weights.push_back(off ? 0.0f
                                           : static_cast<float>(unitRandom(random)) / static_cast<float>(wanted));
        }
      }
      masks.mask_begin.push_back(static_cast<int>(masks.mask_index.size()));
      for (int t = 0; t < compress::kTileTexels; ++t) {
        const bool inside = x * compress::kTileSide + t % compress::kTileSide < shape.width &&
                            y * compress::kTileSide + t / compress::kTileSide < shape.rows;
        masks.texel_weights.push_back(inside && random() % 4 != 0 ? 1.0f : 0.0f);
      }
    }
  }
  return masks;
}

/// Tiles as the references take them: column and row, two ints a tile.
inline std::vector<int> tilePositions(const compress::TileMasks& masks) {
  std::vector<int> positions;
  for (const compress::TilePosition& tile : masks.tiles) {
    positions.push_back(tile.x);
    positions.push_back(tile.y);
  }
  return positions;
}

}  // namespace facezip::test
