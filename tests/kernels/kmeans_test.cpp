#include "problems/kmeans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using compress::clusterFragments;
using compress::Clustering;
using compress::kMaxClusters;
using compress::KmeansOptions;
using compress::KmeansRuns;
using compress::runKmeans;

std::vector<int> labelsOfRun(const KmeansRuns& runs, int mask, int restart) {
  const auto first =
      runs.labels.begin() + (static_cast<std::ptrdiff_t>(mask) * runs.restarts + restart) * runs.expressions;
  return {first, first + runs.expressions};
}

std::vector<int> labelsOfMask(const Clustering& clustering, int mask) {
  const auto first = clustering.labels.begin() + static_cast<std::ptrdiff_t>(mask) * clustering.expressions;
  return {first, first + clustering.expressions};
}

struct Comparison {
  int runs = 0;
  int diverged = 0;
  int refills = 0;
};

/// Every run beside the same run of the reference, which works on the fragments in double.
Comparison compareRuns(const SearchCapture& capture, const KmeansOptions& options) {
  KmeansProblem problem(testDevice(), capture, options);
  problem.run();
  const KmeansRuns runs = problem.result();
  Comparison result;
  for (int k = 0; k < runs.masks; ++k) {
    for (int restart = 0; restart < options.restarts; ++restart, ++result.runs) {
      const reference::KmeansRun expected = problem.expected(k, restart);
      const bool same_end = (runs.iterations[static_cast<std::size_t>(result.runs)] >= 0) == expected.converged;
      if (labelsOfRun(runs, k, restart) != expected.labels || !same_end) ++result.diverged;
      result.refills += expected.refills;
    }
  }
  return result;
}

TEST(Kmeans, EveryRunIsTheReferencesOnAwkwardSizes) {
  const std::vector<int> masks = smallSizesOnly() ? std::vector{1, 2} : std::vector{1, 2, 53};
  const std::vector<int> restarts = smallSizesOnly() ? std::vector{1, 7} : std::vector{1, 7, 64};
  Comparison total;
  for (const int expressions : {1, 2, 3, 4, 5, 16, 20, 37}) {  // three programs: blocks of 16 fragments
    for (const int mask_count : masks) {
      for (const int restart_count : restarts) {
        const Comparison one =
            compareRuns(randomCapture(expressions, mask_count, 11 + static_cast<unsigned>(expressions)),
                        {.clusters = 4, .restarts = restart_count, .max_iterations = 100, .seed = 5});
        total.runs += one.runs;
        total.diverged += one.diverged;
      }
    }
  }
  EXPECT_LE(total.diverged, kDivergedRuns * total.runs) << "of " << total.runs << " runs";
}

TEST(Kmeans, EveryRunIsTheReferencesForOtherClusterCounts) {
  for (const int clusters : {1, 3, kMaxClusters}) {
    SCOPED_TRACE(clusters);
    const Comparison one = compareRuns(randomCapture(19, 3, 3), {.clusters = clusters, .restarts = 16, .seed = 9});
    EXPECT_LE(one.diverged, kDivergedRuns * one.runs);
  }
}

// Few fragments in a plane: about one run in a thousand has a cluster run empty, which is refilled as documented.
TEST(Kmeans, RefillsEmptyClustersLikeTheReference) {
  if (smallSizesOnly()) GTEST_SKIP() << "needs thousands of runs to see a refill";
  const SearchCapture capture = randomCapture(8, 53, 26, Masks::kHard, /* texels_per_mask= */ 2);
  int refills = 0;
  for (const int iterations : {1, 2, 100}) {  // also cut short, before further iterations hide which fragment was taken
    const Comparison all =
        compareRuns(capture, {.clusters = 3, .restarts = 256, .max_iterations = iterations, .seed = 1});
    EXPECT_EQ(all.diverged, 0) << "of " << all.runs << " runs";
    refills += all.refills;
  }
  EXPECT_GT(refills, 10);
}

/// The lowest inertia that Lloyd's iterations reach from any three different fragments as seeds.
double lowestFromAllSeeds(const reference::Points& fragments) {
  double lowest = INFINITY;
  for (std::size_t a = 0; a < fragments.size(); ++a) {
    for (std::size_t b = a + 1; b < fragments.size(); ++b) {
      for (std::size_t c = b + 1; c < fragments.size(); ++c) {
        const auto run = reference::lloyd(fragments, {fragments[a], fragments[b], fragments[c]}, 100);
        lowest = std::min(lowest, reference::inertia(fragments, run.labels, 3));
      }
    }
  }
  return lowest;
}

TEST(Kmeans, FindsTheBestThatAnySeedsLeadTo) {
  for (std::uint64_t seed = 0; seed < (smallSizesOnly() ? 2u : 12u); ++seed) {
    const SearchCapture capture = randomCapture(7, 2, seed);
    const Clustering clustering = clusterFragments(testDevice(), gramsOf(capture), {.clusters = 3, .restarts = 256});
    for (std::size_t k = 0; k < 2; ++k) {
      const double lowest = lowestFromAllSeeds(capture.fragments(k));
      EXPECT_NEAR(clustering.inertia[k], lowest, kDoubleSum * lowest);
    }
  }
}

TEST(Kmeans, WinnersAreFixedPointsAndTheirInertiaIsRight) {
  const SearchCapture capture = randomCapture(37, 2, 21);
  const Clustering clustering = clusterFragments(testDevice(), gramsOf(capture), {.restarts = 8});
  EXPECT_TRUE(clustering.converged);
  for (int k = 0; k < 2; ++k) {
    const auto mask = static_cast<std::size_t>(k);
    const reference::Points fragments = capture.fragments(mask);
    const std::vector<int> labels = labelsOfMask(clustering, k);
    EXPECT_NEAR(clustering.inertia[mask], reference::inertia(fragments, labels, 4),
                kDoubleSum * clustering.inertia[mask]);
    const reference::Points centres = reference::meansOf(fragments, labels, 4);
    for (std::size_t n = 0; n < fragments.size(); ++n) {
      const double own = reference::squaredDistance(fragments[n], centres[static_cast<std::size_t>(labels[n])]);
      for (const auto& centre : centres) {
        EXPECT_LE(own, reference::squaredDistance(fragments[n], centre) + kCentreDistance * clustering.inertia[mask]);
      }
    }
  }
}

/// N expressions of which expression n repeats distinct expression n % distinct, but for a hundred-thousandth. A single
/// one is repeated exactly: after centring nothing else would be left to cluster, and rightly be clustered.
SearchCapture repeatedCapture(int expressions, int distinct, int masks) {
  SearchCapture capture = randomCapture(distinct, masks, 77);
  std::mt19937_64 random(5);
  for (int n = distinct; n < expressions; ++n) {
    capture.differences.push_back(capture.differences[static_cast<std::size_t>(n % distinct)]);
    for (double& value : capture.differences.back()) value += (distinct > 1 ? 1e-3 : 0.0) * uniform(random);
  }
  return capture;
}

TEST(Kmeans, CoincidentFragmentsShareAClusterAndLeaveTheRestEmpty) {
  for (const int expressions : {1, 2, 3, 4, 20, 37, 128}) {
    for (const int distinct : {1, 2, 3, 4}) {
      if (distinct > expressions || (smallSizesOnly() && expressions > 37)) continue;
      SCOPED_TRACE(testing::Message() << expressions << " expressions, " << distinct << " distinct");
      const SearchCapture capture = repeatedCapture(expressions, distinct, 2);
      const KmeansRuns runs = runKmeans(testDevice(), gramsOf(capture), {.restarts = 7});
      for (int run = 0; run < 2 * 7; ++run) {
        const std::vector<int> labels = labelsOfRun(runs, run / 7, run % 7);
        for (int n = 0; n < expressions; ++n) {
          EXPECT_EQ(labels[static_cast<std::size_t>(n)], labels[static_cast<std::size_t>(n % distinct)]);
        }
        // Clusters are filled from 0 on, in the order of their seeds.
        EXPECT_EQ(std::set<int>(labels.begin(), labels.end()).size(), static_cast<std::size_t>(distinct));
        EXPECT_EQ(*std::max_element(labels.begin(), labels.end()), distinct - 1);
        EXPECT_GE(runs.iterations[static_cast<std::size_t>(run)], 1);
      }
    }
  }
}

TEST(Kmeans, ZeroFragmentsAreOneClusterWithoutInertia) {
  SearchCapture capture = randomCapture(5, 1, 1);
  for (auto& difference : capture.differences) std::fill(difference.begin(), difference.end(), 0.0);
  const Clustering clustering = clusterFragments(testDevice(), gramsOf(capture));
  EXPECT_THAT(clustering.labels, testing::Each(0));
  EXPECT_EQ(clustering.inertia, std::vector<double>{0.0});
}

// Four tight groups, a thousand times farther from the neutral than from each other. Floats of the Gram matrix as it
// stands would hold none of the distances inside the groups and little of those between them.
TEST(Kmeans, SeparatesGroupsFarFromTheNeutral) {
  SearchCapture capture = randomCapture(20, 2, 4);
  const SearchCapture groups = randomCapture(4, 2, 6);
  for (std::size_t n = 0; n < 20; ++n) {
    for (std::size_t p = 0; p < capture.texels(); ++p) {
      capture.differences[n][p] = 1e5 + groups.differences[n % 4][p] + 0.01 * capture.differences[n][p];
    }
  }
  const Clustering clustering = clusterFragments(testDevice(), gramsOf(capture));
  for (int k = 0; k < 2; ++k) {
    const std::vector<int> labels = labelsOfMask(clustering, k);
    EXPECT_EQ(std::set<int>(labels.begin(), labels.begin() + 4).size(), 4u);
    for (std::size_t n = 4; n < 20; ++n) EXPECT_EQ(labels[n], labels[n % 4]);
  }
}

// One fragment as strong as 8 bits allow among fragments of noise level: the noise must still be clustered as well as
// in double, where it is left with three clusters.
TEST(Kmeans, OneStrongFragmentDoesNotDrownTheOthers) {
  SearchCapture capture = randomCapture(20, 1, 8);
  for (double& value : capture.differences[7]) value = value > 0.0 ? 25500.0 : -25500.0;
  const Clustering clustering = clusterFragments(testDevice(), gramsOf(capture), {.restarts = 64});
  const reference::Points fragments = capture.fragments(0);
  double best = INFINITY;
  for (int restart = 0; restart < 64; ++restart) {
    best = std::min(best, reference::inertia(fragments, reference::kmeans(fragments, 4, 100, 1, 0, restart).labels, 4));
  }
  EXPECT_LE(clustering.inertia[0], 1.01 * best);
}

TEST(Kmeans, SaysWhenLabelsDidNotStandStill) {
  const SearchCapture capture = randomCapture(37, 4, 2);
  const auto grams = gramsOf(capture);
  const KmeansRuns hasty = runKmeans(testDevice(), grams, {.restarts = 4, .max_iterations = 1});
  EXPECT_THAT(hasty.iterations, testing::Contains(-1));
  EXPECT_FALSE(clusterFragments(testDevice(), grams, {.restarts = 4, .max_iterations = 1}).converged);
  EXPECT_THAT(runKmeans(testDevice(), grams, {.restarts = 4}).iterations, testing::Each(testing::Ge(1)));
}

TEST(Kmeans, EqualPartitionsTieToTheLowestRestart) {
  const SearchCapture capture = randomCapture(5, 1, 3);
  // Restarts 1 and 2 are one partition under two numberings, better than restart 0.
  const KmeansRuns runs{.masks = 1,
                        .restarts = 3,
                        .expressions = 5,
                        .labels = {0, 0, 0, 0, 0, /**/ 2, 0, 1, 3, 3, /**/ 0, 1, 2, 3, 3},
                        .iterations = {1, -1, 1}};
  const Clustering clustering = compress::selectBestRuns(gramsOf(capture), runs, 4);
  EXPECT_EQ(clustering.labels, (std::vector{2, 0, 1, 3, 3}));
  EXPECT_FALSE(clustering.converged);
}

TEST(Kmeans, IsDeterministicAndTheSeedMatters) {
  const auto grams = gramsOf(randomCapture(20, 5, 1));
  const KmeansRuns once = runKmeans(testDevice(), grams, {.restarts = 7, .seed = 3});
  EXPECT_EQ(runKmeans(testDevice(), grams, {.restarts = 7, .seed = 3}).labels, once.labels);
  EXPECT_NE(runKmeans(testDevice(), grams, {.restarts = 7, .seed = 4}).labels, once.labels);
}

TEST(Kmeans, RefusesOptionsOutOfRange) {
  const auto grams = gramsOf(randomCapture(5, 1, 1));
  EXPECT_THROW(clusterFragments(testDevice(), grams, {.clusters = 0}), InputError);
  EXPECT_THROW(clusterFragments(testDevice(), grams, {.clusters = 9}), InputError);
  EXPECT_THROW(clusterFragments(testDevice(), grams, {.restarts = 0}), InputError);
  EXPECT_THROW(clusterFragments(testDevice(), grams, {.max_iterations = 0}), InputError);
}

}  // namespace
}  // namespace facezip::test
