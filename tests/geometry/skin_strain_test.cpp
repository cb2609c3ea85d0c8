#include "facezip/geometry/skin_strain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

/// A flat grid of unit squares.
TriangleMesh flatGrid(int side) {
  TriangleMesh mesh = test::makeSheet(side, side);
  for (int v = 0; v < side * side; ++v) mesh.positions.row(v) << v % side, v / side, 0;
  return mesh;
}

TEST(SkinStrain, ATurnAndAShiftStrainNothing) {
  const TriangleMesh mesh = test::makeSheet(8, 7);
  const SkinStrain strain(mesh.positions, mesh.triangles);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 3).normalized()).matrix();
  const Eigen::MatrixX3d moved = (mesh.positions * turn.transpose()).rowwise() + Eigen::RowVector3d(5, 6, 7);
  EXPECT_LT(strain.tensors(moved, 2).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(strain.edgeChange(moved).maxCoeff(), 1e-12);
  EXPECT_LT((strain.ringLengths(moved) - strain.ringLengths(mesh.positions)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SkinStrain, StretchAndCompressionAreToldApart) {
  const TriangleMesh mesh = flatGrid(6);
  const SkinStrain strain(mesh.positions, mesh.triangles);
  const Eigen::MatrixX3d posed = mesh.positions * Eigen::Vector3d(1.3, 0.8, 1.0).asDiagonal();
  const Eigen::MatrixXd parts = strain.tensors(posed, 3);
  Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(12);
  expected[0] = 0.3;  // xx of the stretch
  expected[7] = 0.2;  // yy of the compression
  EXPECT_LT((parts.rowwise() - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SkinStrain, ProductsDoNotDependOnTheCoordinates) {
  const TriangleMesh mesh = test::makeSheet(8, 7);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.6, Eigen::Vector3d(3, 1, 2).normalized()).matrix();
  Eigen::MatrixX3d a = mesh.positions, b = mesh.positions;
  a.col(0) = a.col(0).array() + 0.2 * a.col(1).array().sin();
  b.col(1) *= 0.7;
  const auto products = [&](const Eigen::Matrix3d& r) {
    const SkinStrain strain(mesh.positions * r.transpose(), mesh.triangles);
    const Eigen::MatrixXd of_a = strain.tensors(a * r.transpose(), 2), of_b = strain.tensors(b * r.transpose(), 2);
    return Eigen::VectorXd(of_a.cwiseProduct(of_b).rowwise().sum());
  };
  const Eigen::VectorXd straight = products(Eigen::Matrix3d::Identity());
  EXPECT_GT(straight.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT((straight - products(turn)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SkinStrain, EdgesCountOnce) {
  const TriangleMesh mesh = flatGrid(3);
  const SkinStrain strain(mesh.positions, mesh.triangles);
  // The centre has six edges: four sides and two diagonals.
  EXPECT_NEAR(strain.ringLengths(mesh.positions)[4], (4 + 2 * std::sqrt(2.0)) / 6, 1e-12);
  EXPECT_NEAR(strain.edgeChange(2.0 * mesh.positions)[4], 1.0, 1e-12);
}

TEST(SkinStrain, DamageDoesNoHarm) {
  const TriangleMesh mesh = test::makeDamagedSheet();
  const SkinStrain strain(mesh.positions, mesh.triangles);
  const Eigen::MatrixX3d posed = 1.1 * mesh.positions;
  EXPECT_TRUE(strain.tensors(posed, 4).allFinite());
  EXPECT_TRUE(strain.edgeChange(posed).allFinite());
  EXPECT_TRUE(strain.ringLengths(posed).allFinite());
}

}  // namespace
}  // namespace facezip::geometry
