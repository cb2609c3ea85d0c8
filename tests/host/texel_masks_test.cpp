#include "raster/texel_masks.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "facezip/geometry/surface_sampling.hpp"
#include "raster/grid_masks.hpp"
#include "small_capture.hpp"

namespace facezip {
namespace {

constexpr auto kWithGutter = raster::TexelMasks::Texels::kCoveredAndGutter;

/// A patch with masks about 5 cm apart.
struct MaskedPatch {
  geometry::TriangleMesh mesh = test::gridMesh(21);
  std::vector<int> triangles = geometry::wholeMeshRegion(mesh);
  geometry::RegionMesh region = geometry::extractRegion(mesh, triangles);
  geometry::SurfaceSamples samples = geometry::samplePoissonDisk(region, 0.05, 3);
  geometry::MaskWeights masks = geometry::compactMaskWeights(geometry::solveMaskWeights(region, samples.vertices));
  raster::TexelMasks texels{mesh, region, masks};
};

TEST(TexelMasks, SumToOneOnEveryMaskedTexelAndNowhereElse) {
  const MaskedPatch patch;
  const raster::UvRaster raster(patch.mesh, patch.triangles, 93, 61, 7);
  const auto samples = raster.rows(0, 61);
  const raster::TileMasks tiles = patch.texels.tiles(raster, 0, 61, kWithGutter);
  std::vector<float> sums(static_cast<std::size_t>(96) * 64, 0.0f);
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    for (int e = tiles.mask_begin[t]; e < tiles.mask_begin[t + 1]; ++e) {
      for (int p = 0; p < raster::kTileTexels; ++p) {
        const int x = tiles.tiles[t].x * 16 + p % 16;
        const int y = tiles.tiles[t].y * 16 + p / 16;
        sums[static_cast<std::size_t>(y * 96 + x)] +=
            tiles.mask_weights[static_cast<std::size_t>(e) * 256 + static_cast<std::size_t>(p)];
      }
    }
  }
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const bool masked = x < 93 && y < 61 && samples[static_cast<std::size_t>(y * 93 + x)].triangle >= 0;
      EXPECT_NEAR(sums[static_cast<std::size_t>(y * 96 + x)], masked ? 1.0f : 0.0f, 1e-5f) << x << ", " << y;
    }
  }
}

TEST(TexelMasks, CountOnlyCoveredTexels) {
  const MaskedPatch patch;
  const raster::UvRaster raster(patch.mesh, patch.triangles, 93, 61, 7);
  const auto samples = raster.rows(0, 61);
  const auto covered = std::count_if(samples.begin(), samples.end(),
                                     [](const auto& s) { return s.kind == raster::TexelSample::Kind::kCovered; });
  const auto count = [](const raster::TileMasks& tiles) {
    return std::count(tiles.texel_weights.begin(), tiles.texel_weights.end(), 1.0f);
  };
  EXPECT_EQ(count(patch.texels.tiles(raster, 0, 61, kWithGutter)), covered);
  EXPECT_EQ(count(patch.texels.tiles(raster, 0, 61, raster::TexelMasks::Texels::kCovered)), covered);
  EXPECT_EQ(count(raster::coverageTiles(raster, 0, 61)), covered);
}

TEST(TexelClasses, AreThoseOfTheRasterInEveryBand) {
  const MaskedPatch patch;
  using Kind = raster::TexelSample::Kind;
  for (const auto& [width, height, gutter] : {std::array{93, 161, 7}, std::array{64, 200, 70}, std::array{33, 17, 0}}) {
    const raster::UvRaster raster(patch.mesh, patch.triangles, width, height, gutter);
    const raster::TexelClasses classes(raster);
    const auto samples = raster.rows(0, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Kind kind = samples[static_cast<std::size_t>(y * width + x)].kind;
        EXPECT_EQ(classes.active(x / 16, y) >> x % 16 & 1u, kind == Kind::kCovered || kind == Kind::kGutter ? 1u : 0u);
        EXPECT_EQ(classes.covered(x / 16, y) >> x % 16 & 1u, kind == Kind::kCovered ? 1u : 0u);
      }
    }
  }
}

TEST(TexelMasks, ActiveTilesHoldTheClassesOfTheirRows) {
  const MaskedPatch patch;
  const raster::UvRaster raster(patch.mesh, patch.triangles, 93, 61, 7);
  const auto samples = raster.rows(32, 61);
  const raster::TileMasks tiles = raster::activeTiles(raster::TexelClasses(raster), 32, 61);
  std::vector<float> active(samples.size(), 0.0f), covered(samples.size(), 0.0f);
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    for (int p = 0; p < raster::kTileTexels; ++p) {
      const int x = tiles.tiles[t].x * 16 + p % 16, y = tiles.tiles[t].y * 16 + p / 16;
      const auto value = static_cast<std::size_t>(p) + t * 256;
      if (x >= 93 || y >= 29) {
        EXPECT_EQ(tiles.mask_weights[value] + tiles.texel_weights[value], 0.0f);
        continue;
      }
      active[static_cast<std::size_t>(y * 93 + x)] = tiles.mask_weights[value];
      covered[static_cast<std::size_t>(y * 93 + x)] = tiles.texel_weights[value];
    }
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(active[i], samples[i].triangle >= 0 ? 1.0f : 0.0f);
    EXPECT_EQ(covered[i], samples[i].kind == raster::TexelSample::Kind::kCovered ? 1.0f : 0.0f);
  }
}

TEST(TexelMasks, OverlapsAreThePairsThatShareATexel) {
  const MaskedPatch patch;
  // So fine that every triangle has texels inside.
  const raster::UvRaster raster(patch.mesh, patch.triangles, 256, 256, 0);
  const raster::TileMasks tiles = patch.texels.tiles(raster, 0, 256, raster::TexelMasks::Texels::kCovered);
  std::set<std::pair<int, int>> expected;
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    for (int a = tiles.mask_begin[t]; a < tiles.mask_begin[t + 1]; ++a) {
      for (int b = a + 1; b < tiles.mask_begin[t + 1]; ++b) {
        for (int p = 0; p < raster::kTileTexels; ++p) {
          const auto weight = [&](int e) {
            return tiles.mask_weights[static_cast<std::size_t>(e) * 256 + static_cast<std::size_t>(p)];
          };
          if (weight(a) * weight(b) == 0.0f) continue;
          expected.emplace(tiles.mask_index[static_cast<std::size_t>(a)],
                           tiles.mask_index[static_cast<std::size_t>(b)]);
        }
      }
    }
  }
  std::set<std::pair<int, int>> got;
  for (const auto& [k, l] : patch.texels.overlappingPairs()) got.emplace(k, l);
  EXPECT_EQ(got, expected);
  const auto masks = static_cast<std::size_t>(patch.masks.mask_count);
  EXPECT_LT(got.size(), masks * (masks - 1) / 2);
}

TEST(WeightGrid, CellsSumToOneEverywhere) {
  const MaskedPatch patch;
  const raster::UvRaster raster(patch.mesh, patch.triangles, 93, 61, 7);
  for (const int scale : {1, 4, 8}) {
    const raster::GridMasks grid = raster::makeGridMasks(patch.texels, raster, scale);
    EXPECT_EQ(grid.columns, (93 + scale - 1) / scale);
    EXPECT_EQ(grid.rows, (61 + scale - 1) / scale);
    ASSERT_EQ(grid.cells.cells(), static_cast<std::size_t>(grid.columns * grid.rows));
    for (std::size_t c = 0; c < grid.cells.cells(); ++c) {
      float sum = 0.0f;
      for (int e = grid.cells.cell_begin[c]; e < grid.cells.cell_begin[c + 1]; ++e)
        sum += grid.cells.mask_weights[static_cast<std::size_t>(e)];
      ASSERT_NEAR(sum, 1.0f, 1e-5f) << "cell " << c << " at 1/" << scale;
    }
  }
}

}  // namespace
}  // namespace facezip
