#include "raster/texel_masks.hpp"

#include <gtest/gtest.h>

#include "facezip/geometry/surface_sampling.hpp"
#include "raster/weight_grid.hpp"
#include "small_capture.hpp"

namespace facezip {
namespace {

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
  const compress::TileMasks tiles = patch.texels.tiles(raster, 0, 61);
  std::vector<float> sums(static_cast<std::size_t>(96) * 64, 0.0f);
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    for (int e = tiles.mask_begin[t]; e < tiles.mask_begin[t + 1]; ++e) {
      for (int p = 0; p < compress::kTileTexels; ++p) {
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
  const auto count = [](const compress::TileMasks& tiles) {
    return std::count(tiles.texel_weights.begin(), tiles.texel_weights.end(), 1.0f);
  };
  EXPECT_EQ(count(patch.texels.tiles(raster, 0, 61)), covered);
  EXPECT_EQ(count(raster::coverageTiles(raster, 0, 61)), covered);
}

TEST(TexelMasks, OverlapsAreThePairsThatShareATile) {
  compress::TileMasks tiles;
  tiles.tiles = {{0, 0}, {1, 0}};
  tiles.mask_begin = {0, 3, 4};
  tiles.mask_index = {0, 2, 3, 1};
  std::vector<bool> overlaps(16, false);
  raster::markOverlaps(tiles, 4, overlaps);
  const std::vector<compress::MaskPair> expected = {{0, 2}, {0, 3}, {2, 3}};
  EXPECT_EQ(raster::overlappingPairs(overlaps, 4), expected);
}

TEST(WeightGrid, CellsSumToOneEverywhere) {
  const MaskedPatch patch;
  const raster::UvRaster raster(patch.mesh, patch.triangles, 93, 61, 7);
  for (const int scale : {1, 4, 8}) {
    const raster::WeightGrid grid = raster::makeWeightGrid(patch.texels, raster, scale);
    EXPECT_EQ(grid.width, (93 + scale - 1) / scale);
    EXPECT_EQ(grid.height, (61 + scale - 1) / scale);
    ASSERT_EQ(grid.cells.cells(), static_cast<std::size_t>(grid.width * grid.height));
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
