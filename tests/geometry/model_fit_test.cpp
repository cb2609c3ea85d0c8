#include "facezip/geometry/model_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

constexpr int kSide = 9;

Eigen::MatrixX3d bump(double cx, double cy) {
  Eigen::MatrixX3d moved = Eigen::MatrixX3d::Zero(kSide * kSide, 3);
  for (int v = 0; v < kSide * kSide; ++v) {
    const double r = std::hypot(v % kSide - cx, v / kSide - cy) / 4.0;
    if (r < 1) moved.row(v) = (1 - r) * (1 - r) * Eigen::RowVector3d(0.3, -0.2, 1.0);
  }
  return moved;
}

const LinearModel& model() {
  static const LinearModel made(test::makeSheet(kSide, kSide).positions, {bump(2.0, 3.0), bump(6.0, 5.0)}, -1.0, 1.0);
  return made;
}

ModelPose truePose(double second) {
  ModelPose pose;
  pose.motion.turn = Eigen::AngleAxisd(0.2, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).matrix();
  pose.motion.scale = 1.1;
  pose.motion.shift << 4.0, -1.0, 2.0;
  pose.coefficients = Eigen::Vector2d(0.7, second);
  return pose;
}

std::vector<PointTarget> targetsOf(const Eigen::MatrixX3d& mesh, const Eigen::Matrix3d& metric) {
  std::vector<PointTarget> targets;
  for (int v = 0; v < mesh.rows(); ++v) targets.push_back({{v, v, v}, {1, 0, 0}, mesh.row(v), metric});
  return targets;
}

ModelPose fitted(const std::vector<PointTarget>& targets, bool scale) {
  ModelPose pose;
  pose.coefficients = Eigen::Vector2d::Zero();
  for (int step = 0; step < 20; ++step) pose = stepModel(model(), pose, targets, {0.0, scale});
  return pose;
}

TEST(ModelFit, RecoversMotionScaleAndCoefficients) {
  const ModelPose truth = truePose(-0.4);
  const ModelPose pose = fitted(targetsOf(truth.place(model()), Eigen::Matrix3d::Identity()), true);
  EXPECT_LT((pose.coefficients - truth.coefficients).norm(), 1e-6);
  EXPECT_NEAR(pose.motion.scale, 1.1, 1e-6);
  EXPECT_LT((pose.place(model()) - truth.place(model())).norm(), 1e-5);
}

TEST(ModelFit, KeepsTheScaleUnlessItMayFitIt) {
  const ModelPose pose = fitted(targetsOf(truePose(-0.4).place(model()), Eigen::Matrix3d::Identity()), false);
  EXPECT_EQ(pose.motion.scale, 1.0);
}

TEST(ModelFit, StaysWithinTheBounds) {
  const Eigen::MatrixX3d mesh = ModelPose{truePose(-3.0)}.place(model());
  const ModelPose pose = fitted(targetsOf(mesh, Eigen::Matrix3d::Identity()), true);
  EXPECT_EQ(pose.coefficients[1], -1.0);
  EXPECT_LE(pose.coefficients.cwiseAbs().maxCoeff(), 1.0);
}

TEST(ModelFit, AMetricOfOneDirectionLeavesTheOthersFree) {
  // All points moved within the plane that the metric does not see.
  Eigen::MatrixX3d mesh = model().mean();
  mesh.col(0).array() += 3.0;
  const ModelPose pose = fitted(targetsOf(mesh, Eigen::Vector3d::UnitZ() * Eigen::RowVector3d::UnitZ()), false);
  EXPECT_LT((pose.place(model()) - model().mean()).col(2).norm(), 1e-6);
}

TEST(ModelFit, APriorHoldsCoefficientsNearZero) {
  const std::vector<PointTarget> targets = targetsOf(truePose(0.5).place(model()), Eigen::Matrix3d::Identity());
  ModelPose pose;
  pose.coefficients = Eigen::Vector2d::Zero();
  for (int step = 0; step < 20; ++step) pose = stepModel(model(), pose, targets, {1e6, true});
  EXPECT_LT(pose.coefficients.norm(), 1e-3);
}

}  // namespace
}  // namespace facezip::geometry
