#include "compress/search/seam_cost.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "reference/seam_cost.hpp"
#include "search_capture.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

using test::randomCapture;
using test::SearchCapture;
using test::testDevice;

/// Labels drawn from the first `used` clusters, so that the others are empty.
Clustering randomClustering(int masks, int expressions, int clusters, int used, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Clustering clustering{.masks = masks, .expressions = expressions, .clusters = clusters, .labels = {}, .inertia = {}};
  for (int i = 0; i < masks * expressions; ++i) {
    clustering.labels.push_back(static_cast<int>(random() % static_cast<unsigned>(used)));
  }
  return clustering;
}

std::vector<int> labelsOfMask(const Clustering& clustering, int mask) {
  const auto first = clustering.labels.begin() + static_cast<std::ptrdiff_t>(mask) * clustering.expressions;
  return {first, first + clustering.expressions};
}

/// Largest squared distance of a fragment of the pair, or of the neutral, from the fragments' mean: what errors scale
/// with.
double spread(const GramMatrices& grams, int pair) {
  const GramMatrices::Matrix gram = grams.slot(grams.slots.pair(pair));
  const double mean_square = gram.mean();
  const Eigen::VectorXd to_mean = gram.diagonal() - 2.0 * gram.rowwise().mean();
  return std::max(mean_square, mean_square + to_mean.maxCoeff());
}

void expectReferenceTables(const SearchCapture& capture, const Clustering& clustering,
                           std::size_t batch_bytes = kSeamBatchBytes) {
  const GramMatrices grams = gramsOf(capture);
  const SeamTables tables = computeSeamTables(testDevice(), grams, clustering, batch_bytes);
  ASSERT_EQ(tables.pairs, grams.slots.pairs);
  ASSERT_EQ(tables.values.size(),
            tables.pairs.size() * static_cast<std::size_t>(clustering.clusters * clustering.clusters));
  for (int j = 0; j < static_cast<int>(tables.pairs.size()); ++j) {
    const auto [k, l] = tables.pairs[static_cast<std::size_t>(j)];
    const double tolerance = test::kSeamCost * spread(grams, j);
    for (int a = 0; a < clustering.clusters; ++a) {
      for (int b = 0; b < clustering.clusters; ++b) {
        const double expected = reference::seamCost(capture.differences, capture.masks[static_cast<std::size_t>(k)],
                                                    capture.masks[static_cast<std::size_t>(l)],
                                                    labelsOfMask(clustering, k), labelsOfMask(clustering, l), a, b);
        ASSERT_NEAR(tables.entry(j, a, b), expected, tolerance) << "pair " << j << ", clusters " << a << ", " << b;
        ASSERT_GE(tables.entry(j, a, b), 0.0);
      }
    }
  }
}

TEST(SeamCost, IsTheReferencesOnAwkwardSizes) {
  const int most_masks = test::smallSizesOnly() ? 3 : 53;
  for (const int expressions : {1, 2, 3, 4, 5, 15, 16, 20, 37}) {
    for (const int masks : {2, most_masks}) {
      SCOPED_TRACE(testing::Message() << expressions << " expressions, " << masks << " masks");
      expectReferenceTables(randomCapture(expressions, masks, 5), randomClustering(masks, expressions, 4, 4, 17));
    }
  }
}

TEST(SeamCost, IsTheReferencesForEveryClusterCount) {
  for (int clusters = 1; clusters <= kMaxClusters; ++clusters) {
    SCOPED_TRACE(clusters);
    expectReferenceTables(randomCapture(20, 3, 5), randomClustering(3, 20, clusters, clusters, 3));
  }
}

TEST(SeamCost, AnEmptyClusterIsTheNeutral) {
  for (const int used : {1, 2, 3}) {
    SCOPED_TRACE(used);
    expectReferenceTables(randomCapture(20, 3, 5), randomClustering(3, 20, 4, used, 3));
  }
}

TEST(SeamCost, BatchesOfPairsMakeNoDifference) {
  const SearchCapture capture = randomCapture(5, 8, 5);
  const Clustering clustering = randomClustering(8, 5, 4, 4, 3);
  expectReferenceTables(capture, clustering, /* batch_bytes= */ 1);
  const GramMatrices grams = gramsOf(capture);
  EXPECT_EQ(computeSeamTables(testDevice(), grams, clustering, 3 * 16 * 16 * sizeof(float)).values,
            computeSeamTables(testDevice(), grams, clustering).values);
}

TEST(SeamCost, EqualClustersCostNothing) {
  Clustering clustering = randomClustering(2, 20, 4, 4, 9);
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
  Clustering clustering = randomClustering(7, 20, 2, 2, 3);
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
  const Clustering clustering = randomClustering(2, 20, 4, 4, 3);
  const SeamTables expected = computeSeamTables(testDevice(), gramsOf(near), clustering);
  const SeamTables tables = computeSeamTables(testDevice(), gramsOf(far), clustering);
  const double tolerance = 2.0 * test::kSeamCost * spread(gramsOf(near), 0);
  for (std::size_t i = 0; i < tables.values.size(); ++i)
    EXPECT_NEAR(tables.values[i], expected.values[i], tolerance) << i;
}

TEST(SeamCost, FragmentsThatCoincideCostNothing) {
  SearchCapture capture = randomCapture(5, 2, 1);
  for (auto& difference : capture.differences) difference = capture.differences.front();
  const SeamTables tables = computeSeamTables(testDevice(), gramsOf(capture), randomClustering(2, 5, 1, 1, 1));
  EXPECT_THAT(tables.values, testing::Each(0.0));
  for (auto& difference : capture.differences) std::fill(difference.begin(), difference.end(), 0.0);
  const SeamTables zero = computeSeamTables(testDevice(), gramsOf(capture), randomClustering(2, 5, 4, 2, 1));
  EXPECT_THAT(zero.values, testing::Each(0.0));
}

TEST(SeamCost, NoPairsNoTables) {
  const SeamTables tables =
      computeSeamTables(testDevice(), gramsOf(randomCapture(5, 1, 1)), randomClustering(1, 5, 4, 4, 1));
  EXPECT_EQ(tables.masks, 1);
  EXPECT_TRUE(tables.values.empty());
}

TEST(SeamCost, WritesNothingBeyondItsOutput) {
  constexpr std::size_t kEntries = 3 * 4 * 4, kCanary = 64;
  device::DeviceContext& context = testDevice();
  const std::vector<float> canary(kEntries + kCanary, -7.0f);
  const SeamCostLaunch launch{
      .pairs = 3,
      .expressions = 5,
      .clusters = 4,
      .gram = context.upload(std::vector<float>(3 * 16 * 16, 0.5f), "gram"),
      .pair_masks = context.upload(std::vector<cl_int>{0, 1, 0, 2, 1, 2}, "pairs"),
      .labels = context.upload(std::vector<std::uint8_t>{0, 1, 2, 3, 0, 3, 2, 1, 0, 0, 1, 1, 1, 1, 1}, "labels"),
      .tables = context.allocate(canary.size() * sizeof(float), CL_MEM_READ_WRITE, "tables")};
  context.write(launch.tables, canary, "tables");
  launchSeamCost(context, launch);
  std::vector<float> values(canary.size());
  context.read(launch.tables, values, "tables");
  for (std::size_t i = 0; i < kEntries; ++i) ASSERT_GE(values[i], 0.0f) << i;
  for (std::size_t i = kEntries; i < values.size(); ++i) ASSERT_EQ(values[i], -7.0f) << i;
}

}  // namespace
}  // namespace facezip::compress
