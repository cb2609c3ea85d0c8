#include "facezip/geometry/part_transfer.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

/// A sheet of skin and a small part above its middle; shape 0 lifts the skin's left half and the part with it, shape 1
/// moves the right half alone.
PartProblem problemOf(const Eigen::Matrix3d& turn, double scale, const Eigen::RowVector3d& shift) {
  const TriangleMesh skin = test::makeSheet(9, 9);
  TriangleMesh part = test::makeSheet(3, 3);
  part.positions *= 0.3;
  const TriangleMesh whole = test::join(skin, part, {4, 4, 2});
  PartProblem problem;
  problem.skin = 81;
  problem.triangles = whole.triangles;
  problem.template_neutral = whole.positions;
  for (int m = 0; m < 2; ++m) {
    Eigen::MatrixX3d shape = whole.positions;
    for (int v = 0; v < 81; ++v) {
      if ((v % 9 < 5) == (m == 0)) shape(v, 2) += 1.0;
    }
    if (m == 0) shape.bottomRows(9).col(2).array() += 0.5;
    problem.template_shapes.push_back(shape);
  }
  const auto onSubject = [&](const Eigen::MatrixX3d& points) {
    return Eigen::MatrixX3d(scale * points * turn.transpose());
  };
  problem.neutral = onSubject(skin.positions).rowwise() + shift;
  for (const Eigen::MatrixX3d& shape : problem.template_shapes) {
    problem.transferred.push_back(onSubject((shape - whole.positions).topRows(81)));
  }
  problem.shapes = problem.transferred;
  return problem;
}

TEST(PartTransfer, PartsGoWithASimilarityOfTheSkin) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 1, 0).normalized()).matrix();
  const Eigen::RowVector3d shift(10, -20, 30);
  const PartProblem problem = problemOf(turn, 1.7, shift);
  const Parts parts = transferParts(problem);
  EXPECT_EQ(parts.count, 1);
  const Eigen::MatrixX3d expected = (1.7 * problem.template_neutral.bottomRows(9) * turn.transpose()).rowwise() + shift;
  EXPECT_LT((parts.neutral - expected).cwiseAbs().maxCoeff(), 1e-9);
  const Eigen::RowVector3d lift = 1.7 * Eigen::RowVector3d(0, 0, 0.5) * turn.transpose();
  EXPECT_LT((parts.shapes[0].rowwise() - lift).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(parts.shapes[1].cwiseAbs().maxCoeff(), 1e-6);
}

TEST(PartTransfer, CoefficientsThatExplainTheSkinDriveThem) {
  PartProblem problem = problemOf(Eigen::Matrix3d::Identity(), 1.0, Eigen::RowVector3d::Zero());
  // The subject's own shape 1 is half of the template's and a quarter of shape 0.
  problem.shapes[1] = 0.5 * problem.transferred[1] + 0.25 * problem.transferred[0];
  const Parts parts = transferParts(problem);
  EXPECT_NEAR(parts.coefficients(1, 0), 0.25, 0.01);
  EXPECT_NEAR(parts.coefficients(1, 1), 0.5, 0.01);
  EXPECT_NEAR(parts.shapes[1](0, 2), 0.125, 0.005);
}

TEST(PartTransfer, PartsAreToldApart) {
  PartProblem problem = problemOf(Eigen::Matrix3d::Identity(), 1.0, Eigen::RowVector3d::Zero());
  const Eigen::Index before = problem.template_neutral.rows();
  for (Eigen::MatrixX3d* positions :
       {&problem.template_neutral, &problem.template_shapes[0], &problem.template_shapes[1]}) {
    positions->conservativeResize(before + 3, 3);
    positions->bottomRows(3) << 0, 0, 3, 1, 0, 3, 0, 1, 3;
  }
  problem.triangles.conservativeResize(problem.triangles.rows() + 1, 3);
  const auto first = static_cast<int>(before);
  problem.triangles.bottomRows(1) << first, first + 1, first + 2;
  const Parts parts = transferParts(problem);
  EXPECT_EQ(parts.count, 2);
  EXPECT_LT((parts.neutral - problem.template_neutral.bottomRows(12)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(PartTransfer, GroupsArePlacedAsOne) {
  PartProblem problem = problemOf(Eigen::Matrix3d::Identity(), 1.0, Eigen::RowVector3d::Zero());
  problem.groups.assign(9, 0);
  problem.groups[8] = 1;
  problem.neutral.col(0) = 1.2 * problem.neutral.col(0);
  const Parts parts = transferParts(problem);
  EXPECT_EQ(parts.count, 2);
  // A group keeps its form, whatever the skin does: its own rows are similar to the template's.
  const auto edge = [](const Eigen::MatrixX3d& rows, int a, int b) { return (rows.row(a) - rows.row(b)).norm(); };
  const Eigen::MatrixX3d before = problem.template_neutral.bottomRows(9);
  const double scale = edge(parts.neutral, 0, 7) / edge(before, 0, 7);
  EXPECT_NEAR(edge(parts.neutral, 2, 3), scale * edge(before, 2, 3), 1e-9);
}

// Roots of lashes go where the skin does; a part that does not lie on it keeps its form.
TEST(PartTransfer, WhatLiesOnTheSkinBendsWithIt) {
  const int beneath[] = {10, 16, 40, 64, 70};
  for (const bool on_skin : {false, true}) {
    PartProblem problem = problemOf(Eigen::Matrix3d::Identity(), 1.0, Eigen::RowVector3d::Zero());
    problem.on_skin = {on_skin};
    for (int i = 0; i < 5; ++i) {
      const int skin = beneath[i];
      problem.template_neutral.row(81 + i) = problem.template_neutral.row(skin);
      for (Eigen::MatrixX3d& shape : problem.template_shapes) shape.row(81 + i) = shape.row(skin);
      problem.neutral(skin, 2) += i == 2 ? -0.05 : 0.05;  // which no similarity has
      problem.shapes[0](skin, 0) += 0.025;                // nor the template's shape
    }
    const Parts parts = transferParts(problem);
    double off = 0.0, moved_off = 0.0;
    for (int i = 0; i < 5; ++i) {
      off = std::max(off, (parts.neutral.row(i) - problem.neutral.row(beneath[i])).norm());
      moved_off = std::max(moved_off, (parts.shapes[0].row(i) - problem.shapes[0].row(beneath[i])).norm());
    }
    EXPECT_EQ(off < 1e-3, on_skin) << off;
    EXPECT_EQ(moved_off < 1e-3, on_skin) << moved_off;
  }
}

}  // namespace
}  // namespace facezip::geometry
