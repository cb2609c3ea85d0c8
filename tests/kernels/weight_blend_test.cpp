#include "blend/weight_blend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "facezip/error.hpp"
#include "reference/weight_blend.hpp"
#include "test_device.hpp"

namespace facezip {
namespace {
using device::KernelVariant;

reference::WeightMaps randomMaps(int columns, int rows, int channels, int expressions) {
  reference::WeightMaps maps{columns, rows, channels, expressions, {}, {}, {}};
  std::mt19937_64 random(7);
  maps.codes.resize(static_cast<std::size_t>(columns * rows * channels * expressions));
  for (unsigned char& code : maps.codes) code = static_cast<unsigned char>(random());
  for (int i = 0; i < channels; ++i) {
    maps.scale.push_back((1.0 + i) / 255.0);
    maps.offset.push_back(-0.3 * i);
  }
  return maps;
}

blend::WeightMaps upload(const reference::WeightMaps& maps, KernelVariant variant) {
  const blend::WeightGrid grid{maps.columns, maps.rows, maps.expressions, maps.scale, maps.offset};
  std::vector<std::byte> codes(grid.codeBytes());
  std::size_t next = 0;
  for (int n = 0; n < maps.expressions; ++n) {
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
      for (int i = 0; i < maps.channels; ++i)
        codes[grid.codeIndex(n, cell, i)] = static_cast<std::byte>(maps.codes[next++]);
    }
  }
  return blend::WeightMaps(test::testDevice(), grid, codes, variant);
}

/// [rows][columns][C]
std::vector<float> download(const blend::WeightMaps& maps) {
  const blend::WeightGrid& grid = maps.grid();
  const std::size_t channels = static_cast<std::size_t>(grid.channels());
  std::vector<float> blocks(grid.blocks() * channels * 16);
  test::testDevice().read(maps.weights(), blocks, "blended weights");
  std::vector<float> weights;
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
    for (std::size_t i = 0; i < channels; ++i) weights.push_back(blocks[(cell / 16 * channels + i) * 16 + cell % 16]);
  }
  return weights;
}

std::vector<float> someWeights(int expressions) {
  std::vector<float> beta;
  for (int n = 0; n < expressions; ++n)
    beta.push_back(n % 3 == 1 ? 0.0f : std::sin(1.0f + 2.0f * static_cast<float>(n)));
  return beta;
}

struct WeightCase {
  int columns, rows, channels, expressions;
};

class WeightBlend : public testing::TestWithParam<std::tuple<WeightCase, KernelVariant>> {};

TEST_P(WeightBlend, AgreesWithTheReference) {
  const auto& [size, variant] = GetParam();
  const reference::WeightMaps maps = randomMaps(size.columns, size.rows, size.channels, size.expressions);
  blend::WeightMaps on_device = upload(maps, variant);
  const std::vector<float> beta = someWeights(size.expressions);
  on_device.blend(beta);
  const std::vector<float> weights = download(on_device);
  const std::vector<double> expected = reference::blendWeights(maps, beta);
  ASSERT_EQ(weights.size(), expected.size());
  // N rounded additions of terms up to 8 in size.
  const double tolerance = 8.0 * (size.expressions + 2) * 6e-8 * size.channels;
  for (std::size_t q = 0; q < expected.size(); ++q) ASSERT_NEAR(weights[q], expected[q], tolerance) << q;
}

TEST_P(WeightBlend, MultipliesEveryCellByItsGain) {
  const auto& [size, variant] = GetParam();
  const reference::WeightMaps maps = randomMaps(size.columns, size.rows, size.channels, size.expressions);
  blend::WeightMaps on_device = upload(maps, variant);
  const std::vector<float> beta = someWeights(size.expressions);
  on_device.blend(beta);
  const std::vector<float> without = download(on_device);
  std::vector<float> gain;
  for (int cell = 0; cell < size.columns * size.rows; ++cell) gain.push_back(0.25f * static_cast<float>(cell % 9));
  on_device.setGain(gain);
  on_device.blend(beta);
  const std::vector<float> weights = download(on_device);
  const std::vector<double> expected = reference::blendWeights(maps, beta, gain);
  const double tolerance = 2.0 * 8.0 * (size.expressions + 2) * 6e-8 * size.channels;
  for (std::size_t q = 0; q < expected.size(); ++q) ASSERT_NEAR(weights[q], expected[q], tolerance) << q;
  on_device.setGain({});
  on_device.blend(beta);
  EXPECT_EQ(download(on_device), without);
}

INSTANTIATE_TEST_SUITE_P(Sizes, WeightBlend,
                         testing::Combine(testing::Values(WeightCase{1, 1, 4, 1}, WeightCase{12, 8, 4, 5},
                                                          WeightCase{13, 7, 3, 52}, WeightCase{5, 9, 8, 2},
                                                          WeightCase{16, 4, 1, 20}),
                                          testing::Values(KernelVariant::kCpu, KernelVariant::kGpu)));

TEST(WeightMaps, ZeroWeightsGiveZero) {
  blend::WeightMaps maps = upload(randomMaps(13, 7, 4, 5), KernelVariant::kAuto);
  maps.blend(std::vector<float>(5, 0.0f));
  for (const float weight : download(maps)) ASSERT_EQ(weight, 0.0f);
}

TEST(WeightMaps, ARangeOfRowsHasTheBitsOfTheWhole) {
  blend::WeightMaps maps = upload(randomMaps(13, 9, 4, 5), KernelVariant::kAuto);
  const std::vector<float> beta = someWeights(5);
  maps.blend(beta);
  const std::vector<float> whole = download(maps);
  maps.blend(std::vector<float>(5, 0.0f));
  maps.blend(beta, 4, 7);
  const std::vector<float> part = download(maps);
  for (std::size_t q = 4 * 13 * 4; q < 7 * 13 * 4; ++q) ASSERT_EQ(part[q], whole[q]) << q;
}

TEST(RequireWeights, NamesTheExpression) {
  const std::vector<std::string> names = {"smile", "jawOpen"};
  EXPECT_THROW(blend::requireWeights(std::vector<float>{1.0f}, names), InputError);
  try {
    blend::requireWeights(std::vector<float>{1.0f, std::numeric_limits<float>::quiet_NaN()}, names);
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.parts().item, "blendshape weight of jawOpen");
  }
}

}  // namespace
}  // namespace facezip
