#include "compress/codes/texture_range.hpp"

#include <gtest/gtest.h>

namespace facezip::compress {
namespace {

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

TEST(ClippedRange, KeepsEveryTileWhereTheShareIsLessThanOne) {
  EXPECT_EQ(clippedRange(risingTiles(20), 2, 0.01)[0].max, 38.0f);
}

TEST(ClippedRange, IsEmptyWithoutTiles) {
  for (const TextureRange& range : clippedRange({}, 3, 0.01)) EXPECT_GT(range.min, range.max);
}

}  // namespace
}  // namespace facezip::compress
