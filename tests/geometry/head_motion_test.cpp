#include "facezip/geometry/head_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

constexpr int kSide = 12;

/// A sheet with two bumps that overlap a little.
struct Sheet {
  Eigen::MatrixX3d neutral = test::makeSheet(kSide, kSide).positions;
  std::vector<Eigen::MatrixX3d> shapes = {bump(3.0, 4.0), bump(8.0, 6.0)};
  WeightSolver rig{neutral, shapes};

  static Eigen::MatrixX3d bump(double cx, double cy) {
    Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(kSide * kSide, 3);
    for (int v = 0; v < kSide * kSide; ++v) {
      const double r = std::hypot(v % kSide - cx, v / kSide - cy) / 4.0;
      if (r < 1) moved.row(v) = (1 - r) * (1 - r) * Eigen::RowVector3d(0.3, -0.2, 1.0);
    }
    return moved;
  }
};

Similarity someMotion() {
  Similarity motion;
  motion.turn = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).matrix();
  motion.shift << 4.0, -1.0, 2.0;
  return motion;
}

TEST(HeadMotion, IsToldFromTheExpression) {
  const Sheet sheet;
  const Eigen::Vector2d weights(0.7, 0.4);
  const Eigen::MatrixX3d posed = sheet.rig.pose(weights);
  const StabilisedMesh stabilised = HeadStabiliser(sheet.rig).stabilise(someMotion().apply(posed));
  EXPECT_LT((stabilised.weights - weights).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT((stabilised.mesh - posed).rowwise().norm().maxCoeff(), 1e-3);
  EXPECT_LT((stabilised.motion.turn - someMotion().turn).norm(), 1e-3);
  EXPECT_EQ(stabilised.motion.scale, 1.0);
  EXPECT_LT((stabilised.projected - sheet.rig.project(stabilised.mesh)).norm(), 1e-9 * stabilised.projected.norm());
}

TEST(HeadMotion, IsThatOfTheVerticesThatCount) {
  const Sheet sheet;
  std::vector<int> used;
  for (int v = 0; v < kSide * (kSide - 2); ++v) used.push_back(v);
  const WeightSolver rig(sheet.neutral, sheet.shapes, used);
  const Eigen::Vector2d weights(0.3, 0.9);
  Eigen::MatrixX3d mesh = someMotion().apply(rig.pose(weights));
  mesh.bottomRows(2 * kSide).array() += 50.0;
  const StabilisedMesh stabilised = HeadStabiliser(rig).stabilise(mesh);
  EXPECT_LT((stabilised.weights - weights).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT((stabilised.motion.turn - someMotion().turn).norm(), 1e-3);
  EXPECT_LT((stabilised.projected - rig.project(stabilised.mesh)).norm(), 1e-9 * stabilised.projected.norm());
}

TEST(HeadMotion, OfAMeshThatDidNotMoveIsNone) {
  const Sheet sheet;
  const Eigen::MatrixX3d posed = sheet.rig.pose(Eigen::Vector2d(0.2, 1.0));
  const StabilisedMesh stabilised = HeadStabiliser(sheet.rig).stabilise(posed);
  EXPECT_LT((stabilised.motion.turn - Eigen::Matrix3d::Identity()).norm(), 1e-3);
  EXPECT_LT((stabilised.mesh - posed).rowwise().norm().maxCoeff(), 1e-3);
}

TEST(HeadMotion, IsMostOfWhatAPoseMissesWhereTheHeadMoved) {
  const Sheet sheet;
  const Eigen::MatrixX3d posed = sheet.rig.pose(Eigen::Vector2d(0.5, 0.5));
  EXPECT_EQ(RigidShare().value(), 0.0);
  RigidShare moved;
  moved.add(sheet.rig, posed, someMotion().apply(posed));
  EXPECT_GT(moved.value(), 0.999);
  RigidShare expression;  // a bump that the rig does not have is no rigid motion
  expression.add(sheet.rig, posed, posed + Sheet::bump(6.0, 6.0));
  EXPECT_LT(expression.value(), 0.5);
  RigidShare both = expression;
  both.add(moved);
  EXPECT_GT(both.value(), expression.value());
  EXPECT_LT(both.value(), moved.value());
}

TEST(HeadMotion, IsUndone) {
  const Sheet sheet;
  EXPECT_LT((undo(someMotion(), someMotion().apply(sheet.neutral)) - sheet.neutral).norm(), 1e-12);
}

}  // namespace
}  // namespace facezip::geometry
