// difference_texture_sizes.hpp - sizes that the tests of difference textures, their ranges and their codes share.
#pragma once

#include <gtest/gtest.h>

#include "problems/difference_texture.hpp"
#include "test_device.hpp"

namespace facezip::test {

struct TextureSizes {
  BandShape shape;
  int masks;
  int most_masks;
  int textures;
};

inline const TextureSizes kTextureSizes[] = {
    {{37, 16, 3, 3, image::SampleType::kUint8}, 3, 2, 4},    {{93, 16, 3, 3, image::SampleType::kUint8}, 5, 4, 4},
    {{93, 10, 1, 1, image::SampleType::kUint8}, 3, 2, 1},    {{40, 16, 4, 3, image::SampleType::kUint16}, 3, 3, 2},
    {{93, 32, 3, 20, image::SampleType::kUint8}, 14, 12, 4}, {{93, 32, 4, 37, image::SampleType::kFloat32}, 13, 12, 8},
    {{93, 10, 1, 6, image::SampleType::kFloat32}, 9, 8, 3}};

/// more  what the problem takes behind the number of textures
template <typename Problem, typename... More>
Problem textureProblem(const TextureSizes& sizes, const More&... more) {
  return Problem(testDevice(), sizes.shape, scatteredMasks(sizes.shape, sizes.masks, sizes.most_masks, 16), sizes.masks,
                 sizes.textures, more...);
}

inline bool isTooLarge(const TextureSizes& sizes) {
  return smallSizesOnly() && (sizes.shape.expressions > 3 || sizes.shape.width * sizes.shape.rows > 930);
}

class TextureTest : public testing::TestWithParam<TextureSizes> {
 protected:
  void SetUp() override {
    if (isTooLarge(GetParam())) GTEST_SKIP() << "small sizes only";
  }
};

/// One expression that differs by 1 everywhere, under one mask that is 1 in the upper half of a tile and 0 below.
struct HalfTile {
  HalfTile() : tiles(testDevice()), textures(testDevice(), {1, 1, 1, {1.0f}}) {
    TileMasks masks;
    masks.tiles = {{0, 0}};
    masks.mask_begin = {0, 1};
    masks.mask_index = {0};
    masks.mask_weights.assign(kTileTexels, 0.0f);
    std::fill_n(masks.mask_weights.begin(), kTileTexels / 2, 1.0f);
    masks.texel_weights.assign(kTileTexels, 1.0f);
    tiles.upload(masks);
    textures.compute(tiles, testDevice().upload(std::vector<cl_short>(kTileTexels, 1), "differences"), shape);
  }

  BandShape shape{16, 16, 1, 1, image::SampleType::kUint8};
  compress::DeviceTiles tiles;
  compress::DifferenceTextures textures;
};

/// A band without a tile.
struct NoTiles {
  NoTiles() : tiles(testDevice()), textures(testDevice(), {1, 1, 2, {0.5f, 0.5f}}) {
    TileMasks none;
    none.mask_begin = {0};
    tiles.upload(none);
    textures.compute(tiles, testDevice().allocate(1, CL_MEM_READ_WRITE, "none"), shape);
  }

  BandShape shape{33, 5, 2, 2, image::SampleType::kUint8};
  compress::DeviceTiles tiles;
  compress::DifferenceTextures textures;
};

}  // namespace facezip::test
