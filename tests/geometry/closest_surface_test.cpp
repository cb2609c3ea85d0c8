#include "facezip/geometry/closest_surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

/// Of a dense sampling of every triangle that may be taken, the least distance; above the true one by at most a step.
double sampledDistance(const TriangleMesh& mesh, const ClosestSurface& surface, const Eigen::RowVector3d& point,
                       const Eigen::RowVector3d& normal, double least_cosine) {
  constexpr int kSteps = 60;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    if (surface.normals().row(t).isZero(0.0) || surface.normals().row(t).dot(normal) < least_cosine) continue;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Eigen::RowVector3d p =
            (i * mesh.positions.row(mesh.triangles(t, 0)) + j * mesh.positions.row(mesh.triangles(t, 1)) +
             (kSteps - i - j) * mesh.positions.row(mesh.triangles(t, 2))) /
            kSteps;
        least = std::min(least, (p - point).norm());
      }
    }
  }
  return least;
}

TEST(ClosestSurface, FindsWhatABruteForceSearchFinds) {
  const TriangleMesh mesh = test::makeDamagedSheet();
  const ClosestSurface surface(mesh.positions, mesh.triangles);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d point(8.0 * std::fmod(0.37 * i, 1.0) - 1.0, 7.0 * std::fmod(0.61 * i, 1.0),
                                6.0 * std::fmod(0.83 * i, 1.0) - 3.0);
    const Eigen::Vector3d normal = Eigen::Vector3d(std::sin(i), std::cos(2.0 * i), 1.5).normalized();
    for (const double least_cosine : {-2.0, 0.5}) {
      const SurfacePoint found = surface.closestFacing(point, normal, least_cosine, 100.0);
      const double expected = sampledDistance(mesh, surface, point.transpose(), normal.transpose(), least_cosine);
      ASSERT_EQ(found.found(), std::isfinite(expected));
      if (!found.found()) continue;
      EXPECT_LE(found.distance, expected + 1e-9);
      EXPECT_GE(found.distance, expected - 0.1) << "nearer than any triangle";
      EXPECT_NEAR(found.barycentric.sum(), 1.0, 1e-12);
      EXPECT_NEAR((found.position - point).norm(), found.distance, 1e-12);
      const SurfacePoint hinted = surface.closestFacing(point, normal, least_cosine, 100.0, found.triangle);
      EXPECT_EQ(hinted.distance, found.distance);
    }
  }
}

TEST(ClosestSurface, TakesTheSideThatFacesAsAsked) {
  // Two sheets that touch nearly, as lips do: the upper one faces down.
  TriangleMesh lower = test::makeSheet(5, 5), upper = lower;
  upper.triangles.col(1).swap(upper.triangles.col(2));
  const TriangleMesh both = test::join(lower, upper, {0.0, 0.0, 0.1});
  const ClosestSurface surface(both.positions, both.triangles);
  const Eigen::Vector3d normal = surface.normals().row(0);
  const Eigen::Vector3d point = upper.positions.row(6).transpose() + Eigen::Vector3d(0.1, 0.2, 0.1);
  const SurfacePoint up = surface.closestFacing(point, normal, 0.3, 10.0);
  const SurfacePoint down = surface.closestFacing(point, -normal, 0.3, 10.0);
  ASSERT_TRUE(up.found() && down.found());
  EXPECT_LT(up.triangle, lower.triangles.rows());
  EXPECT_GE(down.triangle, lower.triangles.rows());
}

TEST(ClosestSurface, KnowsReachUnusedTrianglesAndItsBorder) {
  const TriangleMesh mesh = test::makeSheet(6, 6);
  std::vector<bool> used(static_cast<std::size_t>(mesh.triangles.rows()), true);
  const ClosestSurface whole(mesh.positions, mesh.triangles);
  const Eigen::RowVector3d centre = mesh.positions(mesh.triangles.row(24), Eigen::all).colwise().mean();
  const SurfacePoint inside = whole.closest(centre.transpose());
  ASSERT_EQ(inside.triangle, 24);
  EXPECT_FALSE(whole.onBorder(inside));
  used[24] = false;
  const ClosestSurface holed(mesh.positions, mesh.triangles, used);
  const SurfacePoint beside = holed.closest(centre.transpose());
  ASSERT_TRUE(beside.found());
  EXPECT_NE(beside.triangle, 24);
  EXPECT_TRUE(holed.onBorder(beside)) << "a hole has a border";
  EXPECT_FALSE(holed.closest(centre.transpose(), 0.5 * beside.distance).found());
  const SurfacePoint outside = whole.closest(mesh.positions.row(0).transpose() - Eigen::Vector3d(5, 5, 0));
  EXPECT_TRUE(whole.onBorder(outside));
}

}  // namespace
}  // namespace facezip::geometry
