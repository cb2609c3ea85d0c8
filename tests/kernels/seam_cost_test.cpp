#include "problems/seam_cost.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using compress::Clustering;
using compress::computeSeamTables;
using compress::GramMatrices;
using compress::SeamTables;

void expectReferenceTables(const SearchCapture& capture, const Clustering& clustering,
                           std::size_t batch_bytes = compress::kSeamBatchBytes) {
  SeamCostProblem problem(testDevice(), capture, clustering, batch_bytes);
  problem.run();
  const SeamTables& tables = problem.result();
  ASSERT_EQ(tables.pairs, problem.grams.slots.pairs);
  ASSERT_EQ(tables.values.size(), toSize(tables.pairs.size(), clustering.clusters, clustering.clusters));
  for (int j = 0; j < static_cast<int>(tables.pairs.size()); ++j) {
    const double tolerance = kSeamCost * problem.spread(j);
    for (int a = 0; a < clustering.clusters; ++a) {
      for (int b = 0; b < clustering.clusters; ++b) {
        ASSERT_NEAR(tables.entry(j, a, b), problem.expected(j, a, b), tolerance)
            << "pair " << j << ", clusters " << a << ", " << b;
        ASSERT_GE(tables.entry(j, a, b), 0.0);
      }
    }
  }
}

TEST(SeamCost, IsTheReferencesOnAwkwardSizes) {
  const int most_masks = smallSizesOnly() ? 3 : 53;
  for (const int expressions : {1, 2, 3, 4, 5, 15, 16, 20, 37}) {
    for (const int masks : {2, most_masks}) {
      SCOPED_TRACE(testing::Message() << expressions << " expressions, " << masks << " masks");
      expectReferenceTables(randomCapture(expressions, masks, 5), hashedClustering(masks, expressions, 4, 4, 17));
    }
  }
}

TEST(SeamCost, IsTheReferencesForEveryClusterCount) {
  for (int clusters = 1; clusters <= compress::kMaxClusters; ++clusters) {
    SCOPED_TRACE(clusters);
    expectReferenceTables(randomCapture(20, 3, 5), hashedClustering(3, 20, clusters, clusters, 3));
  }
}

TEST(SeamCost, AnEmptyClusterIsTheNeutral) {
  for (const int used : {1, 2, 3}) {
    SCOPED_TRACE(used);
    expectReferenceTables(randomCapture(20, 3, 5), hashedClustering(3, 20, 4, used, 3));
  }
}

TEST(SeamCost, BatchesOfPairsMakeNoDifference) {
  const SearchCapture capture = randomCapture(5, 8, 5);
  const Clustering clustering = hashedClustering(8, 5, 4, 4, 3);
  expectReferenceTables(capture, clustering, /* batch_bytes= */ 1);
  const GramMatrices grams = gramsOf(capture);
  EXPECT_EQ(computeSeamTables(testDevice(), grams, clustering, 3 * 16 * 16 * sizeof(float)).values,
            computeSeamTables(testDevice(), grams, clustering).values);
}

TEST(SeamCost, EqualClustersCostNothing) {
  Clustering clustering = hashedClustering(2, 20, 4, 4, 9);
  std::copy_n(clustering.labels.begin(), 20, clustering.labels.begin() + 20);
  const SeamTables tables = computeSeamTables(testDevice(), gramsOf(randomCapture(20, 2, 5)), clustering);
  for (int a = 0; a < 4; ++a) EXPECT_EQ(tables.entry(0, a, a), 0.0);
  EXPECT_GT(tables.entry(0, 0, 1), 0.0);
}

// Clusters of one copy and of three copies of the same five expressions have the same mean: their cost is nothing but
// rounding, and rounding has both signs.
TEST(SeamCost, RoundingIsNeverNegative) {
  SearchCapture capture = randomCapture(5, 7, 5);
  for (std::size_t n = 5; n < 20; ++n) capture.differences.push_back(capture.differences[n % 5]);
  Clustering clustering = hashedClustering(7, 20, 2, 2, 3);
  for (std::size_t i = 0; i < clustering.labels.size(); ++i) clustering.labels[i] = i % 20 < 5 ? 0 : 1;
  expectReferenceTables(capture, clustering);
}

// All fragments far from the neutral: costs between clusters that hold fragments keep the precision of their spread.
TEST(SeamCost, KeepsItsPrecisionFarFromTheNeutral) {
  const SearchCapture near = randomCapture(20, 2, 4);
  SearchCapture far = near;
  for (auto& difference : far.differences) {
    for (double& value : difference) value += 1e4;
  }
  const Clustering clustering = hashedClustering(2, 20, 4, 4, 3);
  const SeamTables expected = computeSeamTables(testDevice(), gramsOf(near), clustering);
  const SeamTables tables = computeSeamTables(testDevice(), gramsOf(far), clustering);
  const double tolerance = 2.0 * kSeamCost * SeamCostProblem(testDevice(), near, clustering).spread(0);
  for (std::size_t i = 0; i < tables.values.size(); ++i)
    EXPECT_NEAR(tables.values[i], expected.values[i], tolerance) << i;
}

TEST(SeamCost, FragmentsThatCoincideCostNothing) {
  SearchCapture capture = randomCapture(5, 2, 1);
  for (auto& difference : capture.differences) difference = capture.differences.front();
  const SeamTables tables = computeSeamTables(testDevice(), gramsOf(capture), hashedClustering(2, 5, 1, 1, 1));
  EXPECT_THAT(tables.values, testing::Each(0.0));
  for (auto& difference : capture.differences) std::fill(difference.begin(), difference.end(), 0.0);
  const SeamTables zero = computeSeamTables(testDevice(), gramsOf(capture), hashedClustering(2, 5, 4, 2, 1));
  EXPECT_THAT(zero.values, testing::Each(0.0));
}

TEST(SeamCost, NoPairsNoTables) {
  const SeamTables tables =
      computeSeamTables(testDevice(), gramsOf(randomCapture(5, 1, 1)), hashedClustering(1, 5, 4, 4, 1));
  EXPECT_EQ(tables.masks, 1);
  EXPECT_TRUE(tables.values.empty());
}

TEST(SeamCost, WritesNothingBeyondItsOutput) {
  device::DeviceContext& context = testDevice();
  const GuardedBuffer tables(context, 3 * 4 * 4 * sizeof(float));
  compress::launchSeamCost(
      context,
      {.pairs = 3,
       .expressions = 5,
       .clusters = 4,
       .gram = context.upload(std::vector<float>(3 * 16 * 16, 0.5f), "gram"),
       .pair_masks = context.upload(std::vector<cl_int>{0, 1, 0, 2, 1, 2}, "pairs"),
       .labels = context.upload(std::vector<std::uint8_t>{0, 1, 2, 3, 0, 3, 2, 1, 0, 0, 1, 1, 1, 1, 1}, "labels"),
       .tables = tables.buffer()});
  EXPECT_THAT(tables.read<float>(), testing::Each(testing::Ge(0.0f)));
}

}  // namespace
}  // namespace facezip::test
