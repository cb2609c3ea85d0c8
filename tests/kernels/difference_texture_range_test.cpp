#include "problems/difference_texture_range.hpp"

#include <gtest/gtest.h>

#include "difference_texture_sizes.hpp"

namespace facezip::test {
namespace {

using compress::clippedRange;
using compress::TextureRange;

class DifferenceTextureRange : public TextureTest {};

TEST_P(DifferenceTextureRange, CoversTheTexelsUnderAMask) {
  auto problem = textureProblem<DifferenceTextureRangeProblem>(GetParam());
  problem.run();
  const std::vector<std::pair<float, float>> expected = problem.expected();
  ASSERT_EQ(problem.result().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(problem.result()[i].min, expected[i].first) << i;
    ASSERT_EQ(problem.result()[i].max, expected[i].second) << i;
  }
}

TEST_P(DifferenceTextureRange, OfTheBandHoldsThoseOfItsTiles) {
  auto problem = textureProblem<DifferenceTextureRangeProblem>(GetParam());
  const std::vector<TextureRange> whole =
      problem.finder.find(problem.tiles, problem.shape, problem.textures.textures(), 0, problem.tileCount());
  const auto planes = static_cast<std::size_t>(problem.planes());
  ASSERT_EQ(whole.size(), planes);
  const std::vector<std::pair<float, float>> tiles = problem.expected();
  for (std::size_t plane = 0; plane < planes; ++plane) {
    std::pair<float, float> expected = tiles[plane];
    for (std::size_t i = plane; i < tiles.size(); i += planes) {
      expected = {std::min(expected.first, tiles[i].first), std::max(expected.second, tiles[i].second)};
    }
    EXPECT_EQ(whole[plane].min, expected.first);
    EXPECT_EQ(whole[plane].max, expected.second);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceTextureRange, testing::ValuesIn(kTextureSizes));

TEST(DifferenceTextureRange, LeavesOutTexelsWithoutAMask) {
  HalfTile tile;
  const std::vector<TextureRange> ranges =
      compress::TextureRangeFinder(testDevice(), 1).find(tile.tiles, tile.shape, tile.textures.textures(), 0, 1);
  ASSERT_EQ(ranges.size(), 1u);
  EXPECT_EQ(ranges[0].min, 1.0f);
  EXPECT_EQ(ranges[0].max, 1.0f);
}

TEST(DifferenceTextureRange, IsEmptyWithoutTiles) {
  NoTiles none;
  compress::TextureRangeFinder finder(testDevice(), 1);
  for (const TextureRange& range : finder.find(none.tiles, none.shape, none.textures.textures(), 0, 0)) {
    EXPECT_GT(range.min, range.max);
  }
}

/// Tile t of two planes reaches from -t to 2 t, and from -10 to 10.
std::vector<TextureRange> risingTiles(int count) {
  std::vector<TextureRange> tiles;
  for (int t = 0; t < count; ++t) {
    tiles.push_back({static_cast<float>(-t), static_cast<float>(2 * t)});
    tiles.push_back({-10.0f, 10.0f});
  }
  return tiles;
}

TEST(ClippedRange, LeavesOutTheFarthestTilesAtEachEnd) {
  const std::vector<TextureRange> tiles = risingTiles(200);
  const std::vector<TextureRange> whole = clippedRange(tiles, 2, 0.0);
  EXPECT_EQ(whole[0].min, -199.0f);
  EXPECT_EQ(whole[0].max, 398.0f);
  const std::vector<TextureRange> clipped = clippedRange(tiles, 2, 0.01);  // two of 200
  EXPECT_EQ(clipped[0].min, -197.0f);
  EXPECT_EQ(clipped[0].max, 394.0f);
  EXPECT_EQ(clipped[1].min, -10.0f);
  EXPECT_EQ(clipped[1].max, 10.0f);
}

TEST(ClippedRange, LeavesNoTileFartherOutThanIsAllowed) {
  const std::vector<float> most(400, 1.5f);
  const std::vector<TextureRange> clipped = clippedRange(risingTiles(200), 2, 0.01, most);
  EXPECT_EQ(clipped[0].min, -197.5f) << "-199 lies 1.5 beyond; the share alone would give -197";
  EXPECT_EQ(clipped[0].max, 396.5f);
  EXPECT_EQ(clipped[1].min, -10.0f);
}

TEST(ClippedRange, GrowsByThreeQuartersAtTheMost) {
  std::vector<TextureRange> tiles(200, {-1.0f, 3.0f});
  tiles[7] = {-100.0f, 100.0f};
  const std::vector<TextureRange> clipped = clippedRange(tiles, 1, 0.01, std::vector<float>(200, 0.0f));
  EXPECT_EQ(clipped[0].min, -2.5f);
  EXPECT_EQ(clipped[0].max, 4.5f);
}

TEST(ClippedRange, KeepsEveryTileWhereTheShareIsLessThanOne) {
  EXPECT_EQ(clippedRange(risingTiles(20), 2, 0.01)[0].max, 38.0f);
}

TEST(ClippedRange, IsEmptyWithoutTiles) {
  for (const TextureRange& range : clippedRange({}, 3, 0.01)) EXPECT_GT(range.min, range.max);
}

}  // namespace
}  // namespace facezip::test
