#include "facezip/geometry/mesh_edges.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

TEST(MeshEdges, OfASheet) {
  const TriangleMesh mesh = test::makeSheet(7, 5);
  const auto edges = meshEdges(mesh.triangles);
  EXPECT_EQ(edges.size(), 6u * 5 + 7 * 4 + 6 * 4);  // rows, columns, diagonals
  int borders = 0;
  for (const unsigned char bits : borderEdges(mesh.triangles, std::vector<bool>(48, true))) {
    borders += (bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1);
  }
  EXPECT_EQ(borders, 2 * (6 + 4));
}

TEST(MeshEdges, ATriangleThatIsNotUsedLeavesABorder) {
  const TriangleMesh mesh = test::makeSheet(4, 4);
  std::vector<bool> used(18, true);
  const auto before = borderEdges(mesh.triangles, used);
  used[8] = false;
  const auto after = borderEdges(mesh.triangles, used);
  EXPECT_EQ(after[8], 0);
  int more = 0;
  for (std::size_t t = 0; t < 18; ++t) more += t != 8 && after[t] != before[t] ? 1 : 0;
  EXPECT_EQ(more, 3);
}

TEST(MeshEdges, AnEdgeOfThreeTrianglesIsNoBorder) {
  TriangleMesh mesh = test::makeSheet(3, 3);
  mesh.positions.conservativeResize(10, 3);
  mesh.positions.row(9) << 0, 0, 9;
  test::addTriangle(mesh, 0, 4, 9);  // on the diagonal of the first cell
  const auto borders = borderEdges(mesh.triangles, std::vector<bool>(9, true));
  EXPECT_EQ(borders[8], 0b011) << "all but the edge opposite corner 2";
}

TEST(MeshEdges, AreasAndNormals) {
  const TriangleMesh mesh = test::makeDamagedSheet();
  const Eigen::MatrixX3d normals = triangleNormals(mesh.positions, mesh.triangles);
  double area = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const double of_one = triangleArea(mesh.positions, mesh.triangles, t);
    area += of_one;
    EXPECT_NEAR(normals.row(t).norm(), of_one > 0.0 ? 1.0 : 0.0, 1e-12);
  }
  EXPECT_NEAR(vertexAreas(mesh.positions, mesh.triangles).sum(), area, 1e-9 * area);
  const Eigen::MatrixX3d at_vertices = vertexNormals(mesh.positions, mesh.triangles);
  EXPECT_TRUE(at_vertices.row(mesh.positions.rows() - 1).isZero(0.0)) << "of a triangle of one vertex";
  EXPECT_NEAR(at_vertices.row(10).norm(), 1.0, 1e-12);
}

}  // namespace
}  // namespace facezip::geometry
