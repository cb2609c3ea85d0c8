#include "search/permutation_solver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "reference/permutation_search.hpp"
#include "search/branch_and_bound.hpp"
#include "search/cycle_relaxation.hpp"
#include "search/group_minimum.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

enum class Graph { kComplete, kTree, kCycle, kRandom, kTwoParts };
constexpr Graph kGraphs[] = {Graph::kComplete, Graph::kTree, Graph::kCycle, Graph::kRandom, Graph::kTwoParts};

bool overlaps(Graph graph, int masks, int k, int l, std::mt19937_64& random) {
  switch (graph) {
    case Graph::kTree:
      return k == (l - 1) / 2;
    case Graph::kCycle:
      return l == k + 1 || (k == 0 && l == masks - 1);
    case Graph::kRandom:
      return random() % 3 != 0;
    case Graph::kTwoParts:
      return (k < masks / 2) == (l < masks / 2);
    default:
      return true;
  }
}

/// Random costs in [0, 1) on the pairs of a graph.
SeamTables randomTables(int masks, int clusters, Graph graph, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  SeamTables tables{.masks = masks, .clusters = clusters, .pairs = {}, .values = {}};
  for (int k = 0; k < masks; ++k) {
    for (int l = k + 1; l < masks; ++l) {
      if (!overlaps(graph, masks, k, l, random)) continue;
      tables.pairs.push_back({k, l});
      for (int i = 0; i < clusters * clusters; ++i)
        tables.values.push_back(static_cast<double>(random() >> 11) * 0x1p-53);
    }
  }
  return tables;
}

/// Masks on a grid, each with those around it, like the masks of a face: many triangles, and cycles around them.
SeamTables gridTables(int side, int clusters, std::uint64_t seed) {
  SeamTables tables = randomTables(side * side, clusters, Graph::kComplete, seed);
  SeamTables grid{.masks = tables.masks, .clusters = clusters, .pairs = {}, .values = {}};
  const std::ptrdiff_t size = clusters * clusters;
  for (std::size_t j = 0; j < tables.pairs.size(); ++j) {
    const auto [k, l] = tables.pairs[j];
    if (std::abs(k / side - l / side) > 1 || std::abs(k % side - l % side) > 1) continue;
    grid.pairs.push_back({k, l});
    const auto begin = tables.values.begin() + static_cast<std::ptrdiff_t>(j) * size;
    grid.values.insert(grid.values.end(), begin, begin + size);
  }
  return grid;
}

double lowestCost(const SeamTables& tables) {
  return reference::lowestPermutationCost(tables.masks, tables.clusters, [&](int k, int l, int a, int b) {
    const auto found = std::find(tables.pairs.begin(), tables.pairs.end(), MaskPair{k, l});
    return found == tables.pairs.end() ? 0.0 : tables.entry(static_cast<int>(found - tables.pairs.begin()), a, b);
  });
}

void expectConsistent(const PermutationSolution& solution, const SeamTables& tables) {
  EXPECT_LE(solution.bound, solution.best.cost);
  EXPECT_NEAR(seamCost(tables, solution.best.sigma), solution.best.cost, test::kDoubleSum * solution.best.cost);
  for (int k = 0; k < tables.masks; ++k) {
    std::vector<int> row, expected(static_cast<std::size_t>(tables.clusters));
    for (int i = 0; i < tables.clusters; ++i) row.push_back(solution.best.cluster(k, i));
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_TRUE(std::is_permutation(row.begin(), row.end(), expected.begin(), expected.end())) << "mask " << k;
  }
}

TEST(PermutationSolver, CostAndBoundAreTheOptimumOfFiveMasks) {
  for (const Graph graph : kGraphs) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      SCOPED_TRACE(testing::Message() << "graph " << static_cast<int>(graph) << " seed " << seed);
      const SeamTables tables = randomTables(5, seed == 0 ? 4 : 3, graph, seed);
      const PermutationSolution solution = solvePermutation(tables, {.solver = PermutationSolver::kMessagePassing});
      const double lowest = lowestCost(tables);
      EXPECT_NEAR(solution.best.cost, lowest, test::kDoubleSum * lowest);
      EXPECT_NEAR(solution.bound, lowest, test::kDoubleSum * lowest);
      expectConsistent(solution, tables);
    }
  }
}

// Without any message passing branch and bound has the pairs' minima alone and must still be exact.
TEST(PermutationSolver, BranchAndBoundAloneIsExact) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const SeamTables tables = randomTables(4, 4, Graph::kComplete, 100 + seed);
    const CycleRelaxation relaxation(tables, 0);
    const BranchAndBound search = branchAndBound(relaxation, 1e9, 1'000'000);
    const double lowest = lowestCost(tables);
    EXPECT_NEAR(search.cost, lowest, test::kDoubleSum * lowest);
    EXPECT_EQ(search.bound, search.cost);
    EXPECT_EQ(search.labels.size(), 4u);
  }
}

// What message passing moves about must add up to the same cost for every permutation, or branch and bound would be
// exact for another problem.
TEST(PermutationSolver, BranchAndBoundAgreesBeforeAndAfterMessagePassing) {
  const SeamTables tables = randomTables(6, 3, Graph::kComplete, 77);
  CycleRelaxation relaxation(tables, 1000);
  const double before = branchAndBound(relaxation, 1e9, 1'000'000).cost;
  for (int i = 0; i < 30; ++i) relaxation.iterate();
  const BranchAndBound after = branchAndBound(relaxation, 1e9, 1'000'000);
  EXPECT_NEAR(after.cost, before, test::kDoubleSum * before);
  EXPECT_LE(relaxation.bound(), before);
}

TEST(PermutationSolver, BranchAndBoundOutOfNodesStillBoundsFromBelow) {
  const SeamTables tables = randomTables(5, 3, Graph::kComplete, 12);
  const double lowest = lowestCost(tables);
  const CycleRelaxation relaxation(tables, 0);
  for (const std::int64_t nodes : {0, 1, 5, 25, 125}) {
    const BranchAndBound search = branchAndBound(relaxation, 1e9, nodes);
    EXPECT_LE(search.bound, lowest * (1.0 + test::kDoubleSum)) << nodes << " nodes";
    EXPECT_GE(search.bound, relaxation.bound() * (1.0 - test::kDoubleSum)) << nodes << " nodes";
    EXPECT_LE(search.nodes, nodes);
  }
}

TEST(PermutationSolver, MessagePassingNeverLowersTheBound) {
  const SeamTables tables = gridTables(6, 4, 5);
  CycleRelaxation relaxation(tables, 200);
  std::vector<double> bounds = {relaxation.bound()};
  EXPECT_NEAR(bounds[0], pairwiseBound(tables), test::kDoubleSum * bounds[0]);
  for (int i = 0; i < 40; ++i) {
    relaxation.iterate();
    bounds.push_back(relaxation.bound());
    EXPECT_GE(bounds.back(), bounds[bounds.size() - 2] * (1.0 - test::kDoubleSum));
  }
  EXPECT_GT(bounds.back(), bounds.front());
  EXPECT_LE(bounds.back(), searchPermutation(tables, {}).best.cost);
}

// Three masks are one triangle: the relaxation is the problem itself. A triangle's three pairs once over make it exact.
TEST(PermutationSolver, MessagePassingIsExactOnOneTriangle) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const SeamTables tables = randomTables(3, 4, Graph::kComplete, 200 + seed);
    CycleRelaxation relaxation(tables, 1);
    relaxation.iterate();
    const double lowest = lowestCost(tables);
    EXPECT_NEAR(relaxation.bound(), lowest, test::kDoubleSum * lowest);
  }
}

TEST(PermutationSolver, IsExactOnTreesOfAnySizeAndAnyNumberOfClusters) {
  for (int clusters = 1; clusters <= kMaxClusters; ++clusters) {
    SCOPED_TRACE(clusters);
    const SeamTables tables = randomTables(40, clusters, Graph::kTree, 9);
    const PermutationSolution solution = solvePermutation(tables, {.descent = {.restarts = 2}});
    EXPECT_NEAR(solution.bound, solution.best.cost, test::kDoubleSum * solution.best.cost);
    expectConsistent(solution, tables);
  }
}

TEST(PermutationSolver, BoundsEveryNumberOfClusters) {
  for (int clusters = 1; clusters <= kMaxClusters; ++clusters) {
    SCOPED_TRACE(clusters);
    const SeamTables tables = gridTables(3, clusters, 21);
    const PermutationSolution solution = solvePermutation(tables, {.descent = {.restarts = 20}});
    expectConsistent(solution, tables);
    EXPECT_GT(solution.bound, clusters == 1 ? 0.0 : 0.5 * solution.best.cost);
    if (clusters == 1) {
      EXPECT_NEAR(solution.bound, solution.best.cost, test::kDoubleSum * solution.best.cost);
    }
  }
}

TEST(PermutationSolver, MasksWithoutPairsAndTablesOfZerosCostNothing) {
  SeamTables zeros = gridTables(3, 4, 1);
  std::fill(zeros.values.begin(), zeros.values.end(), 0.0);
  const SeamTables single{.masks = 1, .clusters = 4, .pairs = {}, .values = {}};
  const SeamTables apart{.masks = 5, .clusters = 8, .pairs = {}, .values = {}};
  for (const SeamTables& tables : {zeros, single, apart}) {
    const PermutationSolution solution = solvePermutation(tables, {.descent = {.restarts = 3}});
    EXPECT_EQ(solution.best.cost, 0.0);
    EXPECT_EQ(solution.bound, 0.0);
    expectConsistent(solution, tables);
  }
}

TEST(PermutationSolver, BestIsNeverWorseThanEitherAndTheBoundIsTheSame) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const SeamTables tables = gridTables(7, 4, 50 + seed);
    const auto solve = [&](PermutationSolver solver) {
      return solvePermutation(tables, {.solver = solver, .descent = {.seed = seed}, .branching_budget = 1'000'000});
    };
    const PermutationSolution best = solve(PermutationSolver::kBest);
    const PermutationSolution descent = solve(PermutationSolver::kDescent);
    const PermutationSolution passing = solve(PermutationSolver::kMessagePassing);
    EXPECT_EQ(best.best.cost, std::min(descent.best.cost, passing.best.cost));
    EXPECT_EQ(descent.best.cost, searchPermutation(tables, {.seed = seed}).best.cost);
    EXPECT_TRUE(descent.by_descent);
    EXPECT_FALSE(passing.by_descent);
    EXPECT_TRUE(passing.descent.sweep_costs.empty());
    EXPECT_EQ(best.bound, descent.bound);
    EXPECT_EQ(best.bound, passing.bound);
    EXPECT_TRUE(std::is_sorted(best.bounds.begin(), best.bounds.end()));
  }
}

TEST(PermutationSolver, DoesNotDependOnThreads) {
  const SeamTables tables = gridTables(6, 4, 3);
  const PermutationSolution parallel = solvePermutation(tables, {.branching_budget = 1'000'000});
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const PermutationSolution serial = solvePermutation(tables, {.branching_budget = 1'000'000});
  EXPECT_EQ(serial.best.sigma, parallel.best.sigma);
  EXPECT_EQ(serial.bound, parallel.bound);
  EXPECT_EQ(serial.bounds, parallel.bounds);
}

TEST(PermutationGroup, ProductsAndInverses) {
  for (int clusters = 1; clusters <= kMaxListedClusters; ++clusters) {
    const PermutationGroup group(clusters);
    for (int a = 0; a < group.order(); ++a) {
      EXPECT_EQ(group.product(a, group.inverse(a)), 0);
      EXPECT_EQ(group.product(a, 0), a);
      const int b = (7 * a + 3) % group.order();
      for (int c = 0; c < clusters; ++c)
        EXPECT_EQ(group.image(group.product(a, b), c), group.image(a, group.image(b, c)));
    }
  }
}

TEST(GroupMinimum, IsTheLeastSumOverAllProducts) {
  std::mt19937_64 random(11);
  for (int clusters = 1; clusters <= kMaxListedClusters; ++clusters) {
    const PermutationGroup group(clusters);
    const auto order = static_cast<std::size_t>(group.order());
    std::vector<double> outer(order), inner(order), result(order);
    for (double& value : outer) value = static_cast<double>(random() >> 11) * 0x1p-53;
    for (double& value : inner) value = static_cast<double>(random() >> 11) * 0x1p-53;
    GroupMinimum minimum(group);
    for (int inverted = 0; inverted < 8; ++inverted) {
      SCOPED_TRACE(testing::Message() << "C = " << clusters << ", inverted " << inverted);
      const auto at = [&](int element, int bit) {
        return static_cast<std::size_t>((inverted & bit) != 0 ? group.inverse(element) : element);
      };
      minimum({outer, (inverted & 1) != 0}, {inner, (inverted & 2) != 0}, (inverted & 4) != 0, result);
      for (int a = 0; a < group.order(); ++a) {
        double least = outer[at(0, 1)] + inner[at(a, 2)];
        for (int b = 1; b < group.order(); ++b) {
          least = std::min(least, outer[at(b, 1)] + inner[at(group.product(a, b), 2)]);
        }
        EXPECT_EQ(result[at(a, 4)], least) << "a = " << a;
      }
    }
  }
}

}  // namespace
}  // namespace facezip::compress
