// grid_sizes.hpp - sizes of the problems on the weight grid that the tests of the refinement's steps share.
// A program is compiled for every type of samples, number of channels, textures, expressions and texels of a cell:
// sizes that differ in nothing else cost little.
#pragma once

#include <gtest/gtest.h>

#include "problems/grid.hpp"
#include "test_device.hpp"

namespace facezip::test {

/// Sizes that divide by nothing, bands in the middle of an image, every type of samples, two to eight textures. Half
/// cells are whole in them.
inline const GridSizes kGridSizes[] = {{{45, 37, 3, 7, image::SampleType::kUint8}, 8, 4, 0, 0},
                                       {{45, 32, 3, 7, image::SampleType::kUint8}, 8, 4, 32, 40},
                                       {{7, 5, 3, 7, image::SampleType::kUint8}, 8, 4, 0, 0},
                                       {{70, 48, 1, 18, image::SampleType::kUint16}, 16, 3, 16, 16},
                                       {{33, 16, 4, 4, image::SampleType::kFloat32}, 4, 2, 48, 3},
                                       {{80, 40, 3, 9, image::SampleType::kUint8}, 32, 5, 0, 0},
                                       {{40, 32, 3, 19, image::SampleType::kUint8}, 8, 8, 0, 0},
                                       {{20, 17, 2, 3, image::SampleType::kUint8}, 4, 2, 16, 0}};

/// Cells of odd sides, and row 640 on a cell's centre: 10.5 x 61 - 0.5.
inline const GridSizes kOddSizes[] = {{{70, 16, 3, 3, image::SampleType::kUint8}, 61, 2, 640, 9},
                                      {{20, 18, 2, 3, image::SampleType::kUint8}, 5, 1, 0, 0}};

/// Scattered texels, and a row at either end of the window that is not free, as within an image.
template <typename Problem>
Problem scattered(const GridSizes& sizes) {
  return Problem(testDevice(), sizes, scatteredTexels(sizes.shape, 5), Free::kAllButTheEnds);
}
template <typename Problem>
Problem scattered(const GridSizes& sizes, device::KernelVariant variant) {
  return Problem(testDevice(), sizes, scatteredTexels(sizes.shape, 5), Free::kAllButTheEnds, variant);
}

class GridTest : public testing::TestWithParam<GridSizes> {
 protected:
  void SetUp() override {
    const BandShape& shape = GetParam().shape;
    const bool large = GetParam().textures > 2 || shape.expressions * shape.width * shape.rows > 1100;
    if (smallSizesOnly() && large) GTEST_SKIP() << "small sizes only";
  }
};

class HalfCellTest : public GridTest {
 protected:
  void SetUp() override {
    if (testDevice().resolve(device::KernelVariant::kAuto) != device::KernelVariant::kCpu) {
      GTEST_SKIP() << "on GPUs the turns run on texels";
    }
    GridTest::SetUp();
  }
};

/// One texture, on the smallest of kGridSizes.
inline const GridSizes kOneTexture{{20, 17, 2, 3, image::SampleType::kUint8}, 4, 1, 16, 0};

}  // namespace facezip::test
