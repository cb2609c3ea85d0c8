#include "facezip/geometry/uv_slide.hpp"

#include <gtest/gtest.h>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

/// A flat sheet of 10 by 10 vertices whose UVs are its positions over ten.
TriangleMesh flatSheet() {
  TriangleMesh mesh = test::makeSheet(10, 10);
  for (Eigen::Index v = 0; v < 100; ++v) {
    mesh.positions.row(v) << static_cast<double>(v % 10), static_cast<double>(v / 10), 0.0;
    mesh.uvs.row(v) = 0.1 * mesh.positions.row(v).leftCols<2>();
  }
  return mesh;
}

TEST(UvSlide, VerticesGoToThePointOfTheSurfaceThatHasTheUv) {
  const TriangleMesh mesh = flatSheet();
  const Eigen::MatrixX2d vectors = Eigen::RowVector2d(0.04, -0.03).replicate(100, 1);
  const Eigen::MatrixX3d moved = slideAlongUvs(mesh, vectors);
  EXPECT_LT((moved.row(55) - Eigen::RowVector3d(5.4, 4.7, 0.0)).norm(), 1e-9);
  // At the border the way is shortened, not left: vertex 9 is the lower right corner.
  EXPECT_TRUE(moved.row(9).isApprox(mesh.positions.row(9)));
  EXPECT_GE(moved.leftCols<2>().minCoeff(), -1e-9);
  EXPECT_LE(moved.leftCols<2>().maxCoeff(), 9.0 + 1e-9);
  EXPECT_EQ(slideAlongUvs(mesh, Eigen::MatrixX2d::Zero(100, 2)), mesh.positions);
}

TEST(UvSlide, NothingGoesToAnotherIsland) {
  TriangleMesh second = flatSheet();
  second.uvs.array() += 0.95;  // a twentieth of the layout beside the first one, corner to corner
  const TriangleMesh mesh = test::join(flatSheet(), second, Eigen::RowVector3d(100, 0, 0));
  EXPECT_EQ(uvIslands(mesh).front(), 0);
  EXPECT_EQ(uvIslands(mesh).back(), 1);
  const Eigen::MatrixX3d moved = slideAlongUvs(mesh, Eigen::RowVector2d(0.1, 0.1).replicate(200, 1));
  EXPECT_LE(moved.topRows(100).leftCols<1>().maxCoeff(), 9.0 + 1e-9);
  EXPECT_GE(moved.bottomRows(100).leftCols<1>().minCoeff(), 100.0 - 1e-9);
}

TEST(UvSlide, AVertexOnASeamTakesTheMeanOfBothSides) {
  TriangleMesh mesh = flatSheet();
  // The right half of the sheet has UVs of its own from column 5 on, elsewhere in the layout.
  const Eigen::Index first = mesh.uvs.rows();
  mesh.uvs.conservativeResize(2 * first, 2);
  mesh.uvs.bottomRows(first) = mesh.uvs.topRows(first);
  mesh.uvs.bottomRows(first).col(1).array() += 2.0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    bool right = true;
    for (int k = 0; k < 3; ++k) right = right && mesh.triangles(t, k) % 10 >= 5;
    if (right) mesh.uv_triangles.row(t).array() += static_cast<int>(first);
  }
  Eigen::MatrixX2d vectors = Eigen::MatrixX2d::Zero(2 * first, 2);
  vectors(55, 1) = 0.02;          // up by a fifth on the left side
  vectors(first + 55, 1) = 0.06;  // by three fifths on the right
  EXPECT_LT((slideAlongUvs(mesh, vectors).row(55) - Eigen::RowVector3d(5.0, 5.4, 0.0)).norm(), 1e-9);
}

}  // namespace
}  // namespace facezip::geometry
