#include "problems/weight_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using compress::CellMasks;
using compress::WeightMapper;

TEST(WeightMap, IsTheReferencesOnAwkwardSizes) {
  const std::vector<std::size_t> counts =
      smallSizesOnly() ? std::vector<std::size_t>{1, 67} : std::vector<std::size_t>{1, 7, 64, 333};
  for (const int expressions : {1, 4, 16, 17, 37}) {
    for (const int clusters : {1, 4, 5, 8}) {  // a program each
      for (const std::size_t count : counts) {
        SCOPED_TRACE(testing::Message() << expressions << " expressions, " << clusters << " clusters, " << count
                                        << " cells");
        WeightMapProblem problem(testDevice(),
                                 {.cells = count, .expressions = expressions, .masks = 11, .clusters = clusters});
        problem.run();
        const std::vector<std::uint8_t> bytes = problem.result();
        for (int n = 0; n < expressions; ++n) {
          for (std::size_t cell = 0; cell < count; ++cell) {
            for (int i = 0; i < clusters; ++i) {
              const double expected = problem.expected(n, cell, i);
              const std::uint8_t byte = bytes[problem.layout()(n, cell, i)];
              ASSERT_LE(byte, expected + kWeightRounding) << n << ", " << cell << ", " << i;
              ASSERT_GT(byte + 1.0, expected - kWeightRounding) << n << ", " << cell << ", " << i;
            }
          }
        }
      }
    }
  }
}

TEST(WeightMap, RoundsHalfUpAndStaysWithinAByte) {
  // 0.5 is 127.5; three weights whose floats sum to more than 1; none.
  const CellMasks cells{{0, 2, 5, 5}, {0, 1, 0, 1, 2}, {0.5f, 0.5f, 0.33333337f, 0.33333337f, 0.3333334f}};
  WeightMapper mapper(testDevice(), std::vector{0, 1, 0}, 3, 1, 4);
  std::vector<std::uint8_t> bytes(12);
  mapper.fill(cells, 0, 3, bytes);
  EXPECT_THAT(bytes, testing::ElementsAre(128, 128, 0, 0, 170, 85, 0, 0, 0, 0, 0, 0));
  WeightMapper same(testDevice(), std::vector{0, 0, 0}, 3, 1, 4);
  same.fill(cells, 0, 3, bytes);
  EXPECT_THAT(bytes, testing::ElementsAre(255, 0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0));
}

TEST(WeightMap, RangesJoinToTheWhole) {
  constexpr int kExpressions = 5;
  constexpr int kClusters = 4;
  const CellMasks cells = hashedCells(100, 11, 6, 1);
  WeightMapper mapper(testDevice(), hashedTextures(11, kExpressions, kClusters, 3), 11, kExpressions, kClusters);
  std::vector<std::uint8_t> whole(mapper.outputBytes(100));
  mapper.fill(cells, 0, 100, whole);
  // Rising, falling and empty ranges, so that pooled buffers are larger than what is asked of them.
  for (const auto& [first, count] :
       std::vector<std::pair<std::size_t, std::size_t>>{{0, 10}, {10, 60}, {70, 0}, {70, 7}, {77, 23}}) {
    std::vector<std::uint8_t> part(mapper.outputBytes(count));
    mapper.fill(cells, first, count, part);
    for (std::size_t n = 0; n < kExpressions; ++n) {
      for (std::size_t i = 0; i < count * kClusters; ++i) {
        ASSERT_EQ(part[n * count * kClusters + i], whole[(n * 100 + first) * kClusters + i])
            << first << ", " << n << ", " << i;
      }
    }
  }
}

}  // namespace
}  // namespace facezip::test
