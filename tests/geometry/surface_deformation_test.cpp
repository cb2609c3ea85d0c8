#include "facezip/geometry/surface_deformation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

constexpr int kSide = 15;

TriangleMesh flatSheet() {
  TriangleMesh mesh = test::makeSheet(kSide, kSide);
  mesh.positions.col(2).setZero();
  return mesh;
}

PointTarget at(int vertex, const Eigen::RowVector3d& target) {
  return {{vertex, vertex, vertex}, {1, 0, 0}, target, Eigen::Matrix3d::Identity()};
}

Eigen::VectorXd ones() { return Eigen::VectorXd::Ones(kSide * kSide); }

TEST(SurfaceDeformation, FieldsThatAreLinearOnAFlatMeshCostNothing) {
  const TriangleMesh mesh = flatSheet();
  Stiffness stiffness;
  stiffness.bending = 3.0;
  const SurfaceDeformation deformation(mesh.positions, mesh.triangles, stiffness, ones());
  Eigen::Matrix3d linear;
  linear << 0.1, 0.2, -0.3, 0.05, -0.1, 0.4, 0, 0, 0;
  Eigen::MatrixX3d bent = mesh.positions + mesh.positions * linear;
  bent.rowwise() += Eigen::RowVector3d(1, 2, 3);
  std::vector<PointTarget> targets;  // three vertices say what all do
  for (const int vertex : {3, 100, 220}) targets.push_back(at(vertex, bent.row(vertex)));
  const Eigen::MatrixX3d x = deformation.solve(targets, mesh.positions, mesh.positions, 200, 1e-10);
  EXPECT_LT((x - bent).rowwise().norm().maxCoeff(), 1e-4);
}

TEST(SurfaceDeformation, FollowsDataWhereItIsSoftAndNotWhereItIsStiff) {
  const TriangleMesh mesh = flatSheet();
  std::vector<PointTarget> targets;
  for (int v = 0; v < kSide * kSide; ++v) {
    Eigen::RowVector3d target = mesh.positions.row(v);
    target.z() += std::sin(1.2 * target.x());
    targets.push_back(at(v, target));
  }
  const auto misfit = [&](double bending) {
    Stiffness stiffness;
    stiffness.bending = bending;
    const SurfaceDeformation deformation(mesh.positions, mesh.triangles, stiffness, ones());
    const Eigen::MatrixX3d x = deformation.solve(targets, mesh.positions, mesh.positions, 100, 1e-8);
    double sum = 0.0;
    for (const PointTarget& target : targets) sum += (x.row(target.vertices[0]) - target.target).squaredNorm();
    return std::sqrt(sum / static_cast<double>(targets.size()));
  };
  EXPECT_LT(misfit(0.2), 0.05);
  EXPECT_GT(misfit(20.0), 0.5);
}

TEST(SurfaceDeformation, DoesNotDependOnTheUnit) {
  const TriangleMesh mesh = test::makeSheet(kSide, kSide);
  const auto solved = [&](double unit) {
    Stiffness stiffness;
    stiffness.bending = 2.0 * unit;
    stiffness.membrane = 0.5 * unit;
    stiffness.anchor = 0.01;
    const SurfaceDeformation deformation(unit * mesh.positions, mesh.triangles, stiffness, ones());
    PointTarget pull = at(112, unit * (mesh.positions.row(112) + Eigen::RowVector3d(0, 1, 2)));
    pull.metric *= unit * unit;
    return Eigen::MatrixX3d(deformation.solve({pull}, unit * mesh.positions, unit * mesh.positions, 300, 1e-12) / unit);
  };
  const Eigen::MatrixX3d one = solved(1.0);
  EXPECT_GT((one - mesh.positions).norm(), 0.5);
  EXPECT_LT((solved(1e6) - one).norm(), 1e-6);
  EXPECT_LT((solved(1e-6) - one).norm(), 1e-6);
}

TEST(SurfaceDeformation, TargetsBetweenVerticesAndFromAnyStart) {
  const TriangleMesh mesh = test::makeSheet(kSide, kSide);
  Stiffness stiffness;
  stiffness.bending = 1.0;
  stiffness.anchor = 1e-3;
  const SurfaceDeformation deformation(mesh.positions, mesh.triangles, stiffness, ones());
  const Eigen::RowVector3i triangle = mesh.triangles.row(200);
  const Eigen::RowVector3d barycentric(0.2, 0.3, 0.5);
  const Eigen::RowVector3d goal =
      barycentric * mesh.positions(triangle, Eigen::all) + Eigen::RowVector3d(0.2, 0.1, 0.7);
  const std::vector<PointTarget> targets = {{triangle, barycentric, goal, 1e5 * Eigen::Matrix3d::Identity()}};
  const Eigen::MatrixX3d x = deformation.solve(targets, mesh.positions, mesh.positions, 500, 1e-12);
  EXPECT_LT((barycentric * x(triangle, Eigen::all) - goal).norm(), 1e-3);
  Eigen::MatrixX3d elsewhere = mesh.positions;
  elsewhere.array() += 0.5;
  EXPECT_LT((deformation.solve(targets, mesh.positions, elsewhere, 500, 1e-12) - x).norm(), 1e-5);
}

}  // namespace
}  // namespace facezip::geometry
