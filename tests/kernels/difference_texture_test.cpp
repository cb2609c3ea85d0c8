#include "problems/difference_texture.hpp"

#include <gtest/gtest.h>

#include "difference_texture_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using image::SampleType;

class DifferenceTexture : public TextureTest {};

TEST_P(DifferenceTexture, EqualsReference) {
  auto problem = textureProblem<DifferenceTextureProblem>(GetParam());
  problem.run();
  const std::vector<float> actual = problem.result();
  const std::vector<double> expected = problem.expected();
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(actual[i]), expected[i], kDifferenceTextureRelative * problem.fullScale()) << i;
  }
}

TEST_P(DifferenceTexture, VariantsHaveTheSameBits) {
  auto wide = textureProblem<DifferenceTextureProblem>(GetParam(), device::KernelVariant::kCpu);
  auto narrow = textureProblem<DifferenceTextureProblem>(GetParam(), device::KernelVariant::kGpu);
  wide.run();
  narrow.run();
  EXPECT_EQ(wide.result(), narrow.result());
}

INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceTexture, testing::ValuesIn(kTextureSizes));

TEST(DifferenceTexture, RefusesABufferThatIsTooSmall) {
  const BandShape shape{93, 16, 3, 3, SampleType::kUint8};
  DifferenceTextureProblem problem(testDevice(), shape, scatteredMasks(shape, 3, 1, 2), 3, 4);
  const std::size_t bytes = compress::differenceBufferBytes(shape, problem.tileCount());
  const cl::Buffer small = problem.context.allocate(bytes - 1, CL_MEM_READ_WRITE, "differences");
  EXPECT_THROW(problem.textures.compute(problem.tiles, small, shape), DeviceError);
}

}  // namespace
}  // namespace facezip::test
