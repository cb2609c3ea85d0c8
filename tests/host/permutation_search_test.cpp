#include "search/permutation_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "reference/permutation_search.hpp"
#include "search/texture_assignment.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

/// Tables of random costs in [0, 1) for all pairs of masks, or for those next to each other only.
SeamTables randomTables(int masks, int clusters, std::uint64_t seed, int reach) {
  std::mt19937_64 random(seed);
  SeamTables tables{.masks = masks, .clusters = clusters, .pairs = {}, .values = {}};
  for (int k = 0; k < masks; ++k) {
    for (int l = k + 1; l < masks && l <= k + reach; ++l) {
      tables.pairs.push_back({k, l});
      for (int i = 0; i < clusters * clusters; ++i)
        tables.values.push_back(static_cast<double>(random() >> 11) * 0x1p-53);
    }
  }
  return tables;
}

double lowestCost(const SeamTables& tables) {
  return reference::lowestPermutationCost(tables.masks, tables.clusters, [&](int k, int l, int a, int b) {
    const auto found = std::find(tables.pairs.begin(), tables.pairs.end(), MaskPair{k, l});
    return found == tables.pairs.end() ? 0.0 : tables.entry(static_cast<int>(found - tables.pairs.begin()), a, b);
  });
}

void expectPermutations(const Permutation& permutation) {
  for (int k = 0; k < permutation.masks; ++k) {
    std::vector<int> row;
    for (int i = 0; i < permutation.clusters; ++i) row.push_back(permutation.cluster(k, i));
    std::vector<int> expected(row.size());
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_TRUE(std::is_permutation(row.begin(), row.end(), expected.begin())) << "mask " << k;
  }
}

TEST(PermutationSearch, BestOfTheRestartsIsTheOptimumOfFiveMasks) {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE(seed);
    const SeamTables tables = randomTables(5, seed < 4 ? 4 : 3, seed, /* reach= */ seed % 2 == 0 ? 4 : 2);
    const PermutationRestarts search = searchPermutation(tables, {.restarts = 100, .seed = seed});
    const double lowest = lowestCost(tables);
    EXPECT_NEAR(search.best.cost, lowest, test::kDoubleSum * lowest);
    EXPECT_NEAR(seamCost(tables, search.best.sigma), search.best.cost, test::kDoubleSum * lowest);
    expectPermutations(search.best);
  }
}

// With two masks a sweep solves one assignment problem, which is exact for any number of clusters.
TEST(PermutationSearch, SolvesTheAssignmentOfTwoMasksExactly) {
  for (int clusters = 1; clusters <= kMaxClusters; ++clusters) {
    SCOPED_TRACE(clusters);
    const SeamTables tables = randomTables(2, clusters, 31, 1);
    const double lowest = lowestCost(tables);
    for (const double cost : searchPermutation(tables, {.restarts = 5}).finalCosts()) {
      EXPECT_NEAR(cost, lowest, test::kDoubleSum * lowest);
    }
  }
}

// Masks 0 and 1 must agree, 2 and 3 must agree, and 1 and 2 would rather differ. Turning one mask at a time never
// gets from "all agree" to the optimum, so a single descent ends there half of the time.
TEST(PermutationSearch, RestartsEscapeWhereOneDescentIsStuck) {
  const std::vector<double> agree = {0, 10, 10, 0}, differ = {1, 0, 0, 1};
  SeamTables tables{.masks = 4, .clusters = 2, .pairs = {{0, 1}, {1, 2}, {2, 3}}, .values = {}};
  for (const auto& table : {agree, differ, agree})
    tables.values.insert(tables.values.end(), table.begin(), table.end());
  EXPECT_EQ(identityPermutation(tables).cost, 2.0);

  const PermutationRestarts search = searchPermutation(tables, {.restarts = 40});
  EXPECT_EQ(search.best.cost, 0.0);
  EXPECT_THAT(search.finalCosts(), testing::Contains(0.0));
  EXPECT_THAT(search.finalCosts(), testing::Contains(2.0));
}

TEST(PermutationSearch, SweepsNeverRaiseTheCostAndSettle) {
  const SeamTables tables = randomTables(53, 4, 7, 9);
  const PermutationRestarts search = searchPermutation(tables, {.restarts = 20});
  EXPECT_EQ(search.unconverged_restarts, 0);
  for (const auto& costs : search.sweep_costs) {
    ASSERT_GE(costs.size(), 3u);
    EXPECT_TRUE(std::is_sorted(costs.rbegin(), costs.rend()));
    EXPECT_EQ(costs.back(), costs[costs.size() - 2]);  // the last sweep changed nothing
  }
  const std::vector<double> costs = search.finalCosts();
  EXPECT_EQ(search.best.cost, *std::min_element(costs.begin(), costs.end()));
  EXPECT_LT(search.best.cost, identityPermutation(tables).cost);
}

TEST(PermutationSearch, CountsRestartsThatWereCutOff) {
  const SeamTables tables = randomTables(53, 4, 7, 9);
  const PermutationRestarts search = searchPermutation(tables, {.restarts = 6, .max_sweeps = 1});
  EXPECT_EQ(search.unconverged_restarts, 6);
  for (const auto& costs : search.sweep_costs) EXPECT_EQ(costs.size(), 2u);
}

TEST(PermutationSearch, StartsAreRandomPermutationsOfEveryMask) {
  const SeamTables tables = randomTables(53, 4, 7, 9);
  std::vector<double> starts;
  for (const auto& costs : searchPermutation(tables, {.restarts = 50}).sweep_costs) starts.push_back(costs.front());
  std::sort(starts.begin(), starts.end());
  EXPECT_EQ(std::adjacent_find(starts.begin(), starts.end()), starts.end());
}

TEST(PermutationSearch, ResultDependsOnTheSeedAndNotOnThreads) {
  const SeamTables tables = randomTables(20, 4, 3, 5);
  const PermutationRestarts parallel = searchPermutation(tables, {.restarts = 30, .seed = 2});
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const PermutationRestarts serial = searchPermutation(tables, {.restarts = 30, .seed = 2});
  EXPECT_EQ(serial.best.sigma, parallel.best.sigma);
  EXPECT_EQ(serial.sweep_costs, parallel.sweep_costs);
  EXPECT_NE(searchPermutation(tables, {.restarts = 30, .seed = 3}).sweep_costs, serial.sweep_costs);
}

TEST(PermutationSearch, MasksWithoutPairsAndASingleMaskCostNothing) {
  const SeamTables single{.masks = 1, .clusters = 4, .pairs = {}, .values = {}};
  EXPECT_EQ(searchPermutation(single, {.restarts = 3}).best.cost, 0.0);
  expectPermutations(searchPermutation(single, {.restarts = 3}).best);

  SeamTables apart = randomTables(3, 4, 1, 1);
  apart.masks = 5;  // masks 3 and 4 touch nothing
  const Permutation best = searchPermutation(apart, {.restarts = 10}).best;
  ASSERT_EQ(best.sigma.size(), 20u);
  expectPermutations(best);
}

TEST(PermutationSearch, MedianOfTheFinalCosts) {
  PermutationRestarts search;
  search.sweep_costs = {{9, 5}, {8, 1}, {7, 4}};
  EXPECT_EQ(search.medianFinalCost(), 4.0);
  search.sweep_costs.push_back({6, 2});
  EXPECT_EQ(search.medianFinalCost(), 3.0);
}

TEST(PermutationSearch, RefusesOptionsOutOfRange) {
  const SeamTables tables = randomTables(3, 4, 1, 1);
  EXPECT_THROW(searchPermutation(tables, {.restarts = 0}), InputError);
  EXPECT_THROW(searchPermutation(tables, {.max_sweeps = 0}), InputError);
}

// One mask whose permutation is not its own inverse: sigma and sigma^-1 give different answers.
TEST(TextureAssignment, FollowsSigmaAndNotItsInverse) {
  const Clustering clustering{.masks = 1, .expressions = 5, .clusters = 3, .labels = {0, 1, 1, 0, 1}, .inertia = {0.0}};
  const Permutation permutation{.masks = 1, .clusters = 3, .sigma = {1, 2, 0}, .cost = 0.0};  // texture 0 has cluster 1
  EXPECT_EQ(textureOfExpression(clustering, permutation), (std::vector{2, 0, 0, 2, 0}));
  const float third = 1.0f / 3.0f;
  EXPECT_EQ(differenceCoefficients(clustering, permutation),
            (std::vector{0.0f, third, third, 0.0f, third, /**/ 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, /**/ 0.5f, 0.0f, 0.0f,
                         0.5f, 0.0f}));
}

}  // namespace
}  // namespace facezip::compress
