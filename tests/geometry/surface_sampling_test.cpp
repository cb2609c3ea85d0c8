#include "facezip/geometry/surface_sampling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "facezip/error.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

using testing::HasSubstr;

double distance(const RegionMesh& region, int a, int b) {
  return (region.positions.row(a) - region.positions.row(b)).norm();
}

double smallestGap(const RegionMesh& region, const std::vector<int>& samples) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) smallest = std::min(smallest, distance(region, samples[i], samples[j]));
  }
  return smallest;
}

double largestDistanceToSample(const RegionMesh& region, const std::vector<int>& samples) {
  double largest = 0;
  for (int v = 0; v < region.vertexCount(); ++v) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int sample : samples) nearest = std::min(nearest, distance(region, v, sample));
    largest = std::max(largest, nearest);
  }
  return largest;
}

TEST(SamplePoissonDisk, SamplesAreApartAndCoverEveryVertex) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(25, 19));
  for (const double radius : {0.3, 1.0, 2.5, 7.0, 20.0}) {
    for (const std::uint64_t seed : {0u, 1u, 2u}) {
      const SurfaceSamples samples = samplePoissonDisk(region, radius, seed);
      EXPECT_GE(smallestGap(region, samples.vertices), radius);
      EXPECT_LT(largestDistanceToSample(region, samples.vertices), radius);
      EXPECT_TRUE(std::is_sorted(samples.vertices.begin(), samples.vertices.end()));
      EXPECT_EQ(samples.radius, radius);
    }
  }
}

TEST(SamplePoissonDisk, RadiusBelowEveryEdgeTakesEveryVertex) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(6, 5));
  EXPECT_EQ(samplePoissonDisk(region, 1e-3, 1).vertices.size(), 30u);
}

TEST(SamplePoissonDisk, VerticesExactlyARadiusApartMayBothBeSamples) {
  TriangleMesh mesh = test::makeSheet(2, 2);
  mesh.positions << 0, 0, 0, 3, 0, 0, 0, 4, 0, 3, 4, 0;
  EXPECT_EQ(samplePoissonDisk(test::wholeRegion(mesh), 3, 1).vertices.size(), 4u);
}

TEST(SamplePoissonDisk, SameSeedSameSamplesOtherSeedOthers) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(25, 19));
  std::set<std::vector<int>> distinct;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const std::vector<int> samples = samplePoissonDisk(region, 3, seed).vertices;
    EXPECT_EQ(samples, samplePoissonDisk(region, 3, seed).vertices);
    distinct.insert(samples);
  }
  EXPECT_EQ(distinct.size(), 10u);
}

TEST(SamplePoissonDisk, SeedsFirstSamplesAreSpreadOverAllVertices) {
  // With a radius as large as the mesh one sample is left, the first in order: of 400 seeds, each quarter of the
  // vertices gets 100, give or take 4 standard deviations of 8.7.
  const RegionMesh region = test::wholeRegion(test::makeSheet(20, 20));
  const double diagonal =
      (region.positions.colwise().maxCoeff() - region.positions.colwise().minCoeff()).norm() * (1 - 1e-12);
  std::vector<int> hits(4);
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    for (const int vertex : samplePoissonDisk(region, diagonal, seed).vertices)
      ++hits[static_cast<std::size_t>(vertex / 100)];
  }
  for (const int count : hits) EXPECT_NEAR(count, 100, 35);
}

TEST(SamplePoissonDisk, NeitherPlaceNorUnitMatters) {
  const TriangleMesh mesh = test::makeSheet(25, 19);
  const std::vector<int> expected = samplePoissonDisk(test::wholeRegion(mesh), 2.6, 5).vertices;
  for (const double scale : {1e8, 1e-8}) {
    TriangleMesh moved = mesh;
    moved.positions = (moved.positions * scale).rowwise() + scale * Eigen::RowVector3d(10, -20, 30);
    EXPECT_EQ(samplePoissonDisk(test::wholeRegion(moved), 2.6 * scale, 5).vertices, expected);
  }
}

TEST(SamplePoissonDisk, EveryComponentGetsASample) {
  // A 3 x 3 sheet one unit above a large one: wholly covered by its samples.
  TriangleMesh small = test::makeSheet(3, 3);
  small.positions *= 0.1;
  const TriangleMesh mesh = test::join(test::makeSheet(15, 15), small, {7, 7, 1});
  const RegionMesh region = test::wholeRegion(mesh);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const std::vector<int> samples = samplePoissonDisk(region, 6, seed).vertices;
    std::vector<int> per_component(2);
    for (const int v : samples)
      ++per_component[static_cast<std::size_t>(region.components[static_cast<std::size_t>(v)])];
    EXPECT_GE(per_component[0], 1);
    EXPECT_EQ(per_component[1], 1);
    EXPECT_LT(largestDistanceToSample(region, samples), 6);
  }
}

TEST(SamplePoissonDisk, DamagedAndCoincidentVerticesAreNoTrouble) {
  TriangleMesh mesh = test::makeDamagedSheet();
  mesh.positions.row(9) = mesh.positions.row(30);
  for (const CoincidentVertices coincident : {CoincidentVertices::kWeld, CoincidentVertices::kKeepApart}) {
    const RegionMesh region = extractRegion(mesh, wholeMeshRegion(mesh), coincident);
    const SurfaceSamples samples = samplePoissonDisk(region, 0.01, 1);
    EXPECT_GT(smallestGap(region, samples.vertices), 0);
    EXPECT_LT(largestDistanceToSample(region, samples.vertices), 0.01);
  }
}

TEST(SamplePoissonDisk, RefusesRadiiThatMakeNoSense) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(10, 10));
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(samplePoissonDisk(region, bad, 1), InputError) << bad;
  }
  try {
    samplePoissonDisk(region, 300, 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("diagonal of the face region"), HasSubstr("unit")));
  }
}

TEST(SampleByCount, GivesTheCountAndARadiusThatReproducesIt) {
  const RegionMesh region = test::wholeRegion(test::makeSheet(25, 19));
  for (const int count : {1, 2, 5, 53, 100, 474, 475}) {
    const SurfaceSamples samples = sampleByCount(region, count, 7);
    EXPECT_EQ(samples.vertices.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(samplePoissonDisk(region, samples.radius, 7).vertices, samples.vertices);
  }
}

TEST(SampleByCount, RefusesMoreThanVerticesAndFewerThanComponents) {
  const RegionMesh region = test::wholeRegion(test::join(test::makeSheet(4, 4), test::makeSheet(4, 4), {9, 0, 0}));
  EXPECT_EQ(sampleByCount(region, 2, 1).vertices.size(), 2u);
  EXPECT_EQ(sampleByCount(region, 32, 1).vertices.size(), 32u);
  for (const int bad : {-1, 0, 1, 33}) EXPECT_THROW(sampleByCount(region, bad, 1), InputError) << bad;
}

TEST(SampleByCount, NamesTheNearestCountsWhereNoneFits) {
  // The corners of a square: all four, two across a diagonal (any two at a side are nearer), or one.
  TriangleMesh mesh = test::makeSheet(2, 2);
  mesh.positions << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0;
  try {
    sampleByCount(test::wholeRegion(mesh), 3, 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 or 4"));
  }
}

}  // namespace
}  // namespace facezip::geometry
