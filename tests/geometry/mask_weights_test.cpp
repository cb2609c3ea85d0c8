#include "facezip/geometry/mask_weights.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numeric>
#include <vector>

#include "../reference/mask_weights.hpp"
#include "facezip/error.hpp"
#include "facezip/geometry/surface_sampling.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

using testing::ElementsAre;
using testing::FloatEq;

// Rows of phi sum to 1 but for rounding, which the condition of the bilaplacian magnifies: 7e-12 was seen on 9,409
// vertices, so a hundred times less than what is allowed here.
constexpr double kRowSumTolerance = 1e-9;

double largestDifferenceToReference(const RegionMesh& region, const std::vector<int>& samples) {
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : region.triangles.rowwise()) triangles.push_back({t[0], t[1], t[2]});
  const auto expected = reference::maskWeights(static_cast<std::size_t>(region.vertexCount()), triangles, samples);
  const Eigen::MatrixXd phi = solveMaskWeights(region, samples);
  double largest = 0;
  for (Eigen::Index v = 0; v < phi.rows(); ++v) {
    for (Eigen::Index k = 0; k < phi.cols(); ++k) {
      const double value = expected[static_cast<std::size_t>(v)][static_cast<std::size_t>(k)];
      largest = std::max(largest, std::abs(phi(v, k) - value));
    }
  }
  return largest;
}

TEST(SolveMaskWeights, EqualsTheDenseReference) {
  const RegionMesh sheet = test::wholeRegion(test::makeSheet(9, 8));
  EXPECT_LT(largestDifferenceToReference(sheet, {0}), 1e-9);
  EXPECT_LT(largestDifferenceToReference(sheet, {71, 3, 40}), 1e-9);
  EXPECT_LT(largestDifferenceToReference(sheet, samplePoissonDisk(sheet, 2.2, 1).vertices), 1e-9);
  const RegionMesh damaged = test::wholeRegion(test::makeDamagedSheet());
  EXPECT_LT(largestDifferenceToReference(damaged, samplePoissonDisk(damaged, 2.2, 1).vertices), 1e-9);
  const RegionMesh two = test::wholeRegion(test::join(test::makeSheet(6, 5), test::makeSheet(5, 5), {2, 2, 1}));
  EXPECT_LT(largestDifferenceToReference(two, samplePoissonDisk(two, 2.2, 1).vertices), 1e-9);
}

TEST(SolveMaskWeights, OneAtTheOwnSampleZeroAtOthersAndRowsSumToOne) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(30, 25));
  const std::vector<int> samples = samplePoissonDisk(region, 4, 3).vertices;
  const Eigen::MatrixXd phi = solveMaskWeights(region, samples);
  ASSERT_EQ(phi.rows(), region.vertexCount());
  const auto count = static_cast<Eigen::Index>(samples.size());
  EXPECT_EQ(Eigen::MatrixXd(phi(samples, Eigen::all)), Eigen::MatrixXd::Identity(count, count));
  EXPECT_LT((phi.rowwise().sum().array() - 1).abs().maxCoeff(), kRowSumTolerance);
}

TEST(SolveMaskWeights, OneSampleIsOneEverywhere) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(30, 25));
  const Eigen::MatrixXd phi = solveMaskWeights(region, std::vector<int>{17});
  EXPECT_LT((phi.array() - 1).abs().maxCoeff(), kRowSumTolerance);
}

TEST(SolveMaskWeights, ComponentsDoNotSeeEachOther) {
  const RegionMesh region = test::wholeRegion(test::join(test::makeSheet(12, 9), test::makeSheet(8, 8), {3, 3, 0.5}));
  ASSERT_EQ(region.component_count, 2);
  const std::vector<int> samples = samplePoissonDisk(region, 3, 1).vertices;
  const Eigen::MatrixXd phi = solveMaskWeights(region, samples);
  for (int v = 0; v < region.vertexCount(); ++v) {
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (region.components[static_cast<std::size_t>(v)] != region.components[static_cast<std::size_t>(samples[k])]) {
        EXPECT_EQ(phi(v, static_cast<Eigen::Index>(k)), 0);
      }
    }
  }
}

TEST(SolveMaskWeights, ComponentsOfSamplesAloneNeedNoSystem) {
  const RegionMesh region = test::wholeRegion(test::join(test::makeSheet(2, 2), test::makeSheet(6, 6), {30, 0, 0}));
  std::vector<int> samples = {0, 1, 2, 3, 20};
  EXPECT_LT((solveMaskWeights(region, samples).rowwise().sum().array() - 1).abs().maxCoeff(), kRowSumTolerance);
  samples.resize(static_cast<std::size_t>(region.vertexCount()));
  std::iota(samples.begin(), samples.end(), 0);
  EXPECT_EQ(BiharmonicSolver(region, samples).freeCount(), 0);
  EXPECT_EQ(solveMaskWeights(region, samples), Eigen::MatrixXd::Identity(40, 40));
}

TEST(SolveMaskWeights, PositionsDoNotMatter) {
  const TriangleMesh mesh = test::makeSheet(12, 9);
  const std::vector<int> samples = {5, 50, 100};
  const Eigen::MatrixXd expected = solveMaskWeights(test::wholeRegion(mesh), samples);
  for (const double scale : {1e8, 1e-8}) {
    TriangleMesh moved = mesh;
    moved.positions = (moved.positions * scale).array() + 3 * scale;
    EXPECT_EQ(solveMaskWeights(test::wholeRegion(moved), samples), expected);
  }
}

TEST(SolveMaskWeights, RefusesBadSamples) {
  const RegionMesh region = test::wholeRegion(test::join(test::makeSheet(4, 4), test::makeSheet(4, 4), {9, 0, 0}));
  for (const std::vector<int>& bad : {std::vector<int>{}, {0}, {20}, {0, 20, 0}, {-1, 20}, {0, 32}}) {
    EXPECT_THROW(solveMaskWeights(region, bad), InputError);
  }
}

TEST(BiharmonicSolver, SolvesManyRightHandSidesWithOneFactorisation) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(20, 20));
  const std::vector<int> samples = samplePoissonDisk(region, 4, 1).vertices;
  const auto count = static_cast<Eigen::Index>(samples.size());
  const BiharmonicSolver solver(region, samples);
  const Eigen::MatrixXd phi = solver.solve(Eigen::MatrixXd::Identity(count, count));
  EXPECT_LE(solver.residual(phi), BiharmonicSolver::kResidualBound);
  Eigen::MatrixXd values(count, 2);
  for (Eigen::Index k = 0; k < count; ++k) values.row(k) << std::sin(1.0 + static_cast<double>(k)), 7;
  const Eigen::MatrixXd interpolated = solver.solve(values);
  EXPECT_LT((interpolated - phi * values).cwiseAbs().maxCoeff(), kRowSumTolerance);
  EXPECT_LT((interpolated.col(1).array() - 7).abs().maxCoeff(), 7 * kRowSumTolerance);
  EXPECT_EQ(Eigen::MatrixXd(interpolated(samples, Eigen::all)), values);
  EXPECT_THROW(solver.solve(values.topRows(1)), InputError);
}

TEST(BiharmonicSolver, ResidualNoticesAWrongSolutionAndSolveRefusesNaN) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(20, 20));
  const std::vector<int> samples = {0, 200};
  const BiharmonicSolver solver(region, samples);
  Eigen::MatrixXd phi = solver.solve(Eigen::MatrixXd::Identity(2, 2));
  phi(100, 1) += 1e-6;
  EXPECT_GT(solver.residual(phi), BiharmonicSolver::kResidualBound);
  EXPECT_THROW(solver.solve(Eigen::MatrixXd::Constant(2, 1, std::numeric_limits<double>::quiet_NaN())), SolverError);
}

TEST(CompactMaskWeights, ClampsCutsAndNormalises) {
  Eigen::MatrixXd phi(4, 4);
  phi << 1.5, -0.5, 0.005, 0,  // overshoot
      0.5, 0.495, 0.005, 0,    // a tail
      0.25, 0.25, 0.25, 0.25,  // nothing to do
      0, 0, 0, 1;              // a sample
  const MaskWeights masks = compactMaskWeights(phi, 0.01);
  EXPECT_EQ(masks.mask_count, 4);
  EXPECT_EQ(masks.vertexCount(), 4);
  EXPECT_THAT(masks.row_begin, ElementsAre(0, 1, 3, 7, 8));
  EXPECT_THAT(masks.mask_index, ElementsAre(0, 0, 1, 0, 1, 2, 3, 3));
  EXPECT_THAT(masks.weight, ElementsAre(FloatEq(1), FloatEq(0.5 / 0.995), FloatEq(0.495 / 0.995), FloatEq(0.25),
                                        FloatEq(0.25), FloatEq(0.25), FloatEq(0.25), FloatEq(1)));
  EXPECT_DOUBLE_EQ(masks.cost.largest_overshoot, 0.5);
  EXPECT_NEAR(masks.cost.largest_removed, 0.005, 1e-12);
  EXPECT_NEAR(masks.cost.mean_removed, (0.005 / 1.005 + 0.005) / 4, 1e-12);
  EXPECT_DOUBLE_EQ(masks.cost.mean_active_before, (2 + 3 + 4 + 1) / 4.0);
  EXPECT_DOUBLE_EQ(masks.cost.mean_active_after, (1 + 2 + 4 + 1) / 4.0);
}

TEST(CompactMaskWeights, ARowsLargestStaysHoweverSmall) {
  const MaskWeights masks = compactMaskWeights(Eigen::MatrixXd::Constant(1, 200, 0.005), 0.01);
  EXPECT_THAT(masks.mask_index, ElementsAre(0));
  EXPECT_THAT(masks.weight, ElementsAre(1.0f));
}

TEST(CompactMaskWeights, RowsOfRealMasksSumToOneAndStayAboveTheCutoff) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(40, 30));
  const Eigen::MatrixXd phi = solveMaskWeights(region, samplePoissonDisk(region, 4, 1).vertices);
  for (const double cutoff : {0.0, 0.01, 0.2}) {
    const MaskWeights masks = compactMaskWeights(phi, cutoff);
    ASSERT_EQ(masks.vertexCount(), region.vertexCount());
    for (int v = 0; v < masks.vertexCount(); ++v) {
      const auto begin = masks.weight.begin() + masks.row_begin[static_cast<std::size_t>(v)];
      const auto end = masks.weight.begin() + masks.row_begin[static_cast<std::size_t>(v) + 1];
      EXPECT_NEAR(std::accumulate(begin, end, 0.0), 1, 1e-6);
      EXPECT_GT(*std::min_element(begin, end), 0);
    }
    EXPECT_LE(masks.cost.mean_active_after, masks.cost.mean_active_before);
  }
  EXPECT_EQ(compactMaskWeights(phi, 0).cost.largest_removed, 0);
}

TEST(CompactMaskWeights, RefusesCutoffsAndRowsThatMakeNoSense) {
  const Eigen::MatrixXd phi = Eigen::MatrixXd::Constant(2, 2, 0.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-0.1, 1.0, nan}) EXPECT_THROW(compactMaskWeights(phi, bad), InputError);
  EXPECT_THROW(compactMaskWeights(-phi), InputError);
  EXPECT_THROW(compactMaskWeights(Eigen::MatrixXd::Constant(2, 2, nan)), InputError);
  EXPECT_THROW(compactMaskWeights(Eigen::MatrixXd(2, 0)), InputError);
}

}  // namespace
}  // namespace facezip::geometry
