#include "facezip/geometry/topology.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "facezip/error.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <typename Action>
std::string refusal(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

std::string refusal(const TriangleMesh& neutral, const TriangleMesh& expression) {
  return refusal([&] { requireSameTopology(neutral, "neutral.obj", expression, "smile.obj"); });
}

TEST(RequireSameTopology, AcceptsMovedVerticesAndMissingUvs) {
  const TriangleMesh neutral = test::makeSheet(5, 4);
  TriangleMesh expression = neutral;
  expression.positions.array() += 1;
  expression.uvs.array() += 1e-6;
  EXPECT_NO_THROW(requireSameTopology(neutral, "a", expression, "b"));
  expression.uvs.resize(0, 2);
  expression.uv_triangles.resize(0, 3);
  EXPECT_NO_THROW(requireSameTopology(neutral, "a", expression, "b"));
}

TEST(RequireSameTopology, NamesTheFirstDifference) {
  const TriangleMesh neutral = test::makeSheet(5, 4);
  EXPECT_THAT(refusal(neutral, test::makeSheet(5, 5)),
              AllOf(HasSubstr("smile.obj"), HasSubstr("vertices"), HasSubstr("20 as in neutral.obj"), HasSubstr("25")));

  TriangleMesh expression = neutral;
  test::addTriangle(expression, 0, 1, 2);
  EXPECT_THAT(refusal(neutral, expression), HasSubstr("number of triangles"));

  expression = neutral;
  std::swap(expression.triangles(7, 0), expression.triangles(7, 1));
  EXPECT_THAT(refusal(neutral, expression), HasSubstr("triangle 7"));

  expression = neutral;
  expression.uv_triangles(3, 2) = 0;
  EXPECT_THAT(refusal(neutral, expression), HasSubstr("texture coordinate 1 (vertex"));

  expression = neutral;
  expression.uvs(9, 1) += 1e-3;
  EXPECT_THAT(refusal(neutral, expression), HasSubstr("texture coordinate 10"));

  expression = neutral;
  expression.uvs(9, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(neutral, expression), HasSubstr("texture coordinate 10"));
}

TEST(RequireSameTopology, TexturesCoordinatesAreComparedWhereTheyAreUsed) {
  const TriangleMesh neutral = test::makeSheet(5, 4);
  // Each corner with a coordinate of its own, from the last to the first.
  TriangleMesh expression = neutral;
  expression.uvs.resize(3 * neutral.triangles.rows(), 2);
  for (Eigen::Index t = 0; t < neutral.triangles.rows(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto own = static_cast<int>(expression.uvs.rows() - 1 - 3 * t - corner);
      expression.uvs.row(own) = neutral.uvs.row(neutral.uv_triangles(t, corner));
      expression.uv_triangles(t, corner) = own;
    }
  }
  EXPECT_NO_THROW(requireSameTopology(neutral, "a", expression, "b"));
  EXPECT_NO_THROW(requireSameTopology(expression, "a", neutral, "b"));
  // Four decimals are what some exporters write.
  expression.uvs = (expression.uvs * 1e4).array().round() / 1e4;
  EXPECT_NO_THROW(requireSameTopology(neutral, "a", expression, "b"));
  expression.uvs(7, 0) += 3e-4;
  EXPECT_THAT(refusal(neutral, expression), HasSubstr("texture coordinate 8"));
}

TEST(RequireSameTopology, FacesMayBeginAtAnyCorner) {
  TriangleMesh neutral = test::makeSheet(2, 2);  // two triangles, one quad 0 1 3 2
  neutral.triangles << 0, 1, 3, 0, 3, 2;
  neutral.uv_triangles = neutral.triangles;
  neutral.polygons = {0, 0};
  TriangleMesh turned = neutral;
  turned.triangles << 3, 2, 0, 3, 0, 1;  // the same quad, cut along the same diagonal
  turned.uv_triangles = turned.triangles;
  EXPECT_NO_THROW(requireSameTopology(neutral, "a", turned, "b"));
  turned.triangles << 1, 3, 2, 1, 2, 0;  // and along the other one
  turned.uv_triangles = turned.triangles;
  EXPECT_NO_THROW(requireSameTopology(neutral, "a", turned, "b"));
  turned.uv_triangles = neutral.uv_triangles;  // textures turn with the vertices
  EXPECT_THAT(refusal(neutral, turned), HasSubstr("texture coordinate"));
  turned.uv_triangles = turned.triangles;
  turned.polygons = {0, 1};  // two triangles are no quad
  EXPECT_THAT(refusal(neutral, turned), HasSubstr("triangle 0"));
  turned = neutral;
  turned.triangles << 0, 2, 3, 0, 3, 1;  // inside out
  turned.uv_triangles = turned.triangles;
  EXPECT_THAT(refusal(neutral, turned), HasSubstr("1 2 4 3 as in neutral.obj, got 1 3 4 2"));
  // Triangles, too.
  TriangleMesh triangles = test::makeSheet(4, 4);
  TriangleMesh rotated = triangles;
  rotated.triangles.row(5) << triangles.triangles(5, 1), triangles.triangles(5, 2), triangles.triangles(5, 0);
  rotated.uv_triangles = rotated.triangles;
  EXPECT_NO_THROW(requireSameTopology(triangles, "a", rotated, "b"));
}

TEST(RequireUvs, NeedsThemInsideTheUnitSquare) {
  TriangleMesh mesh = test::makeSheet(5, 4);
  EXPECT_NO_THROW(requireUvs(mesh, "neutral.obj"));
  mesh.uvs(0, 0) = -1e-6;  // rounding
  EXPECT_NO_THROW(requireUvs(mesh, "neutral.obj"));
  mesh.uvs(13, 0) = 1.25;
  EXPECT_THAT(refusal([&] { requireUvs(mesh, "neutral.obj"); }),
              AllOf(HasSubstr("neutral.obj"), HasSubstr("coordinate 14"), HasSubstr("vertex 14"), HasSubstr("1.25")));
  mesh.uvs(13, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(requireUvs(mesh, "neutral.obj"), InputError);
}

TEST(RequireUvs, TrianglesOutsideTheRegionMayLieInOtherTiles) {
  TriangleMesh mesh = test::makeSheet(5, 4);
  mesh.uvs(19, 0) += 1;  // the last corner, of triangles 22 and 23
  const std::vector<int> region = {0, 1, 2, 3};
  EXPECT_NO_THROW(requireUvs(mesh, "neutral.obj", region));
  EXPECT_THROW(requireUvs(mesh, "neutral.obj"), InputError);
}

TEST(RequireUvs, RefusesMeshesWithout) {
  TriangleMesh mesh = test::makeSheet(5, 4);
  mesh.uvs.resize(0, 2);
  mesh.uv_triangles.resize(0, 3);
  EXPECT_THAT(refusal([&] { requireUvs(mesh, "neutral.obj"); }), HasSubstr("texture coordinates"));
}

}  // namespace
}  // namespace facezip::geometry
