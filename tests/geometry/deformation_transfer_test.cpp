#include "facezip/geometry/deformation_transfer.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

Eigen::Matrix3d someTurn() { return Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).matrix(); }

/// A bump in the middle of a sheet; its border stays put.
Eigen::MatrixX3d bump(const Eigen::MatrixX3d& sheet, int columns, double height) {
  Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(sheet.rows(), 3);
  for (Eigen::Index v = 0; v < sheet.rows(); ++v) {
    const double x = static_cast<double>(v % columns) - 6, y = static_cast<double>(v / columns) - 6;
    const double r = std::sqrt(x * x + y * y) / 5;
    if (r < 1) moved.row(v) << 0.2 * height * (1 - r) * x, 0, height * (1 - r) * (1 - r);
  }
  return moved;
}

TEST(DeformationTransfer, OntoItselfIsTheIdentity) {
  const TriangleMesh mesh = test::makeSheet(13, 13);
  const Eigen::MatrixX3d moved = bump(mesh.positions, 13, 2.0);
  const auto shapes = transferShapes(mesh.positions, {mesh.positions + moved}, mesh.positions, mesh.triangles);
  EXPECT_LT((shapes[0] - moved).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(DeformationTransfer, FollowsASimilarityOfTheTarget) {
  const TriangleMesh mesh = test::makeSheet(13, 13);
  const Eigen::MatrixX3d moved = bump(mesh.positions, 13, 2.0);
  for (const double scale : {0.01, 1.0, 250.0}) {
    const Eigen::MatrixX3d target =
        (scale * mesh.positions * someTurn().transpose()).rowwise() + Eigen::RowVector3d(3, -5, 900);
    const auto shapes = transferShapes(mesh.positions, {mesh.positions + moved}, target, mesh.triangles);
    EXPECT_LT((shapes[0] - scale * moved * someTurn().transpose()).cwiseAbs().maxCoeff(), 1e-6 * scale) << scale;
  }
}

// Sumner and Popovic: what happens to an edge depends on how long it is on the target.
TEST(DeformationTransfer, AWiderTargetMovesFurther) {
  const TriangleMesh mesh = test::makeSheet(13, 13);
  Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(169, 3);
  for (int v = 0; v < 169; ++v) moved(v, 0) = v % 13 < 6 ? 0.0 : 0.3 * (mesh.positions(v, 0) - mesh.positions(6, 0));
  Eigen::MatrixX3d wide = mesh.positions;
  wide.col(0) *= 2.0;
  const auto shapes = transferShapes(mesh.positions, {mesh.positions + moved}, wide, mesh.triangles);
  EXPECT_NEAR(shapes[0](84 + 6, 0) / moved(84 + 6, 0), 2.0, 0.15);
}

TEST(DeformationTransfer, StillVerticesStayPutExactly) {
  const TriangleMesh mesh = test::makeSheet(13, 13);
  Eigen::MatrixX3d other = mesh.positions;
  other.col(2) += 0.4 * (mesh.positions.col(0) * 1.3).array().sin().matrix();
  const Eigen::MatrixX3d moved = bump(mesh.positions, 13, 2.0);
  const auto shapes = transferShapes(mesh.positions, {mesh.positions + moved, mesh.positions}, other, mesh.triangles);
  const Eigen::VectorXd still = stillVertices(mesh.positions, moved);
  EXPECT_GT(still.sum(), 40);
  for (Eigen::Index v = 0; v < 169; ++v) {
    if (still[v] > 0) {
      EXPECT_EQ(shapes[0].row(v).norm(), 0.0) << v;
    }
  }
  EXPECT_GT(shapes[0].rowwise().norm().maxCoeff(), 1.0);
  EXPECT_EQ(shapes[1].norm(), 0.0);  // a shape that moves nothing
}

TEST(DeformationTransfer, DegenerateTrianglesAndLooseVerticesDoNoHarm) {
  const TriangleMesh mesh = test::makeDamagedSheet();
  Eigen::MatrixX3d shape = mesh.positions;
  shape.row(24) += Eigen::RowVector3d(0, 0, 1);
  const auto shapes = transferShapes(mesh.positions, {shape}, mesh.positions, mesh.triangles);
  EXPECT_TRUE(shapes[0].allFinite());
  EXPECT_NEAR(shapes[0](24, 2), 1.0, 1e-3);
}

TEST(Similarity, IsFoundAgain) {
  const Eigen::MatrixX3d from = test::makeSheet(6, 5).positions;
  const Eigen::MatrixX3d to = (2.5 * from * someTurn().transpose()).rowwise() + Eigen::RowVector3d(4, 5, 6);
  const Similarity found = fitSimilarity(from, to);
  EXPECT_NEAR(found.scale, 2.5, 1e-12);
  EXPECT_LT((found.turn - someTurn()).norm(), 1e-12);
  EXPECT_LT((found.apply(from) - to).norm(), 1e-10);
  EXPECT_EQ(fitSimilarity(from, to, {}, /* fixed_scale= */ true).scale, 1.0);
  // One far point that does not count, and a mirror image that must not come out.
  Eigen::MatrixX3d spoilt = to;
  spoilt.row(3).setConstant(1e3);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(30);
  weights[3] = 0;
  EXPECT_LT((fitSimilarity(from, spoilt, weights).turn - someTurn()).norm(), 1e-12);
  EXPECT_GT(fitSimilarity(from, from * Eigen::Vector3d(-1, 1, 1).asDiagonal()).turn.determinant(), 0.0);
}

}  // namespace
}  // namespace facezip::geometry
