#include "problems/compress_stretch.hpp"

#include <gtest/gtest.h>

#include "grid_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using image::SampleType;

class CompressStretch : public testing::TestWithParam<GridSizes> {};

TEST_P(CompressStretch, EqualsReference) {
  const GridSizes& sizes = GetParam();
  if (smallSizesOnly() && sizes.shape.expressions > 3) GTEST_SKIP() << "small sizes only";
  for (const device::KernelVariant variant : variants()) {
    CompressStretchProblem problem(testDevice(), sizes, scatteredTexels(sizes.shape, 5), variant);
    problem.spoilOtherCells();
    problem.run();
    const std::vector<float> actual = problem.result();
    for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
      for (int plane = 0; plane < problem.planes(); ++plane) {
        for (int t = 0; t < kTileTexels; ++t) {
          ASSERT_NEAR(static_cast<double>(actual[problem.textureLayout()(tile, plane, t)]),
                      problem.expected(tile, plane, t), kCompressStretch * sizes.shape.expressions)
              << "tile " << tile << " plane " << plane << " texel " << t;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, CompressStretch,
                         testing::Values(GridSizes{{93, 16, 3, 3, SampleType::kUint8}, 8, 2, 0, 0},
                                         GridSizes{{93, 10, 1, 1, SampleType::kUint8}, 8, 2, 32, 0},
                                         GridSizes{{7, 1, 4, 3, SampleType::kUint16}, 8, 2, 16, 0},
                                         GridSizes{{64, 16, 2, 2, SampleType::kFloat32}, 1, 2, 0, 0},
                                         GridSizes{{48, 32, 3, 20, SampleType::kUint8}, 5, 2, 16, 0},
                                         GridSizes{{33, 16, 3, 37, SampleType::kUint8}, 64, 2, 0, 0},
                                         GridSizes{{33, 16, 3, 37, SampleType::kUint8}, 64, 2, 112, 0},
                                         GridSizes{{20, 16, 3, 3, SampleType::kUint8}, 61, 2, 640, 0}));

TEST(CompressStretchLaunch, RefusesBuffersThatAreTooSmall) {
  const GridSizes sizes{{40, 16, 3, 3, SampleType::kUint8}, 8, 2, 0, 0};
  CompressStretchProblem problem(testDevice(), sizes, scatteredTexels(sizes.shape, 5));
  const auto buffer = [&](std::size_t bytes) {
    return problem.context.allocate(bytes, CL_MEM_READ_WRITE, "too small");
  };
  const std::size_t bytes = compress::differenceBufferBytes(problem.shape, problem.tileCount());
  const cl::Buffer few = buffer(bytes - 1);
  EXPECT_THROW(compress::launchCompressStretch(problem.context, {problem.tiles, problem.shape, few, 0, 8},
                                               problem.window, false, problem.textures.buffer()),
               DeviceError);
  const cl::Buffer small = buffer(problem.textureLayout().size() * sizeof(float) - 1);
  EXPECT_THROW(compress::launchCompressStretch(problem.context, problem.band(), problem.window, false, small),
               DeviceError);
}

}  // namespace
}  // namespace facezip::test
