#include "facezip/geometry/surface_gradient.hpp"

#include <gtest/gtest.h>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

TEST(SurfaceGradient, OfALinearFieldIsItsTangentialPart) {
  const TriangleMesh mesh = test::makeSheet(7, 5);
  const SurfaceGradient gradient(mesh.positions, mesh.triangles);
  Eigen::Matrix3d slope;
  slope << 1, 2, 3, -4, 5, 6, 7, -8, 9;
  const Eigen::MatrixXd expected = gradient.axes() * slope;  // d/da (x slope) = a slope
  EXPECT_LT((gradient.of(mesh.positions * slope) - expected).cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::MatrixXd flat = gradient.of(Eigen::MatrixX3d::Constant(35, 3, 4.5));
  EXPECT_LT(flat.cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SurfaceGradient, TrianglesWithoutAreaDoNotCount) {
  const TriangleMesh mesh = test::makeDamagedSheet();
  const SurfaceGradient gradient(mesh.positions, mesh.triangles);
  EXPECT_EQ(gradient.degenerateTriangles(), 2);
  EXPECT_TRUE(gradient.of(mesh.positions).allFinite());
}

class ScreenedPoissonTest : public testing::TestWithParam<double> {};

TEST_P(ScreenedPoissonTest, GivesBackTheFieldOfItsGradients) {
  TriangleMesh mesh = test::join(test::makeSheet(7, 5), test::makeSheet(4, 6), {30, 0, 0});
  mesh.positions *= GetParam();
  const SurfaceGradient gradient(mesh.positions, mesh.triangles);
  const ScreenedPoisson solver(gradient, mesh.triangles, 10 * GetParam());
  const Eigen::MatrixXd field = (mesh.positions / GetParam()).array().sin().matrix();
  const Eigen::MatrixXd divergence = solver.divergence(gradient.of(field));
  EXPECT_LT((solver.solve(divergence, field) - field).cwiseAbs().maxCoeff(), 1e-9);
  // Gradients say nothing of the offset of each part: it is that of what the field is held to.
  const Eigen::MatrixXd moved = field.rowwise() + Eigen::RowVector3d(1, -2, 3);
  EXPECT_LT((solver.solve(divergence, moved) - moved).cwiseAbs().maxCoeff(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(AnyUnit, ScreenedPoissonTest, testing::Values(1.0, 1e-6, 1e6));

TEST(ScreenedPoisson, UnusedVerticesStayWhereTheyAreHeld) {
  const TriangleMesh mesh = test::makeDamagedSheet();
  const SurfaceGradient gradient(mesh.positions, mesh.triangles);
  const ScreenedPoisson solver(gradient, mesh.triangles, 5.0);
  const Eigen::MatrixXd near = Eigen::MatrixXd::Constant(mesh.positions.rows(), 3, 0.25);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(2 * mesh.triangles.rows(), 3);
  EXPECT_LT((solver.solve(solver.divergence(none), near) - near).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace facezip::geometry
