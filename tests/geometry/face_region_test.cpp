#include "facezip/geometry/face_region.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "../temporary_directory.hpp"
#include "facezip/error.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<int> readIndices(const std::string& text, int triangle_count) {
  const test::TemporaryDirectory directory;
  std::ofstream(directory / "face_region.txt") << text;
  return readTriangleIndices(directory / "face_region.txt", triangle_count);
}

std::string refusal(const std::string& text, int triangle_count) {
  try {
    readIndices(text, triangle_count);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(ReadTriangleIndices, SortsAndMerges) {
  EXPECT_THAT(readIndices("# the face\n7 3\t5\r\n\n3 # again\n0", 8), ElementsAre(0, 3, 5, 7));
}

TEST(ReadTriangleIndices, NamesTheLineOfABadIndex) {
  for (const char* bad : {"8", "-1", "x", "1.5", "99999999999", "1,2"}) {
    EXPECT_THAT(refusal(std::string("0 1\n# note\n2 ") + bad + "\n", 8),
                AllOf(HasSubstr("face_region.txt"), HasSubstr("line 3"), HasSubstr("from 0 to 7")))
        << bad;
  }
  EXPECT_THAT(refusal("# nothing\n", 8), HasSubstr("none"));
  EXPECT_THROW(readTriangleIndices("/nowhere/at/all.txt", 8), InputError);
  EXPECT_THROW(readTriangleIndices(test::TemporaryDirectory().path(), 8), InputError);
}

TEST(RegionFromPredicate, TakesTrianglesWithMostOfTheirAreaPainted) {
  const TriangleMesh mesh = test::makeSheet(11, 5);  // u of column x: (x + 0.5) / 11
  EXPECT_EQ(regionFromPredicate(mesh, [](double, double) { return true; }), wholeMeshRegion(mesh));
  EXPECT_TRUE(regionFromPredicate(mesh, [](double, double) { return false; }).empty());
  // Up to three quarters of the way from column 4 to column 5: of the quads there, the triangle with its long side on
  // column 5 has 9/16 painted, the other 15/16. At a quarter they have 1/16 and 7/16.
  const auto painted = [&mesh](double limit) {
    return regionFromPredicate(mesh, [limit](double u, double) { return u * 11 - 0.5 < limit; });
  };
  EXPECT_EQ(painted(4.75).size(), 2u * 5 * 4);
  EXPECT_EQ(painted(4.25).size(), 2u * 4 * 4);
  EXPECT_EQ(painted(4.5).size(), (2u * 4 + 1) * 4);
}

TEST(ExtractRegion, KeepsOrderAndMaps) {
  const TriangleMesh mesh = test::makeSheet(6, 5);
  const std::vector<int> triangles = {20, 3, 21, 3};
  const RegionMesh region = extractRegion(mesh, triangles);
  EXPECT_THAT(region.mesh_triangles, ElementsAre(3, 20, 21));
  EXPECT_TRUE(std::is_sorted(region.mesh_vertices.begin(), region.mesh_vertices.end()));
  EXPECT_EQ(region.vertexCount(), 7);
  for (int t = 0; t < region.triangleCount(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto vertex = static_cast<std::size_t>(region.triangles(t, corner));
      const int original = mesh.triangles(region.mesh_triangles[static_cast<std::size_t>(t)], corner);
      EXPECT_EQ(region.mesh_vertices[vertex], original);
      EXPECT_EQ(region.region_vertices[static_cast<std::size_t>(original)], region.triangles(t, corner));
      EXPECT_EQ(region.positions.row(region.triangles(t, corner)), mesh.positions.row(original));
    }
  }
  EXPECT_EQ(std::count(region.region_vertices.begin(), region.region_vertices.end(), -1), 30 - 7);
  EXPECT_EQ(region.component_count, 2);
}

TEST(ExtractRegion, NumbersComponentsByTheirLowestVertex) {
  const TriangleMesh mesh = test::join(test::makeSheet(4, 3), test::makeSheet(3, 3), {50, 0, 0});
  const RegionMesh region = test::wholeRegion(mesh);
  EXPECT_EQ(region.component_count, 2);
  for (int v = 0; v < 21; ++v) EXPECT_EQ(region.components[static_cast<std::size_t>(v)], v < 12 ? 0 : 1);
}

TEST(ExtractRegion, LeavesOutUnusedVerticesAndKeepsDegenerateTriangles) {
  const TriangleMesh mesh = test::makeDamagedSheet();
  const RegionMesh region = test::wholeRegion(mesh);
  EXPECT_EQ(region.vertexCount(), mesh.positions.rows() - 1);
  EXPECT_EQ(region.triangleCount(), mesh.triangles.rows());
  EXPECT_EQ(region.region_vertices[42], -1);
  EXPECT_EQ(region.component_count, 2);  // the sheet with its fin, and the lone vertex
}

TEST(ExtractRegion, WeldsVerticesThatWereSplitAtUvSeams) {
  // Two sheets whose touching columns have the same positions, as after an export that splits seams.
  TriangleMesh left = test::makeSheet(4, 5);
  TriangleMesh right = left;
  for (int y = 0; y < 5; ++y) right.positions.row(4 * y) = left.positions.row(4 * y + 3);
  for (int y = 0; y < 5; ++y) {
    for (int x = 1; x < 4; ++x) right.positions(4 * y + x, 0) += 3;
  }
  const TriangleMesh mesh = test::join(left, right, {0, 0, 0});
  const RegionMesh welded = test::wholeRegion(mesh);
  EXPECT_EQ(welded.component_count, 1);
  EXPECT_EQ(welded.vertexCount(), 35);
  EXPECT_EQ(welded.region_vertices[20], welded.region_vertices[3]);
  EXPECT_EQ(welded.mesh_vertices[static_cast<std::size_t>(welded.region_vertices[20])], 3);

  const RegionMesh apart = extractRegion(mesh, wholeMeshRegion(mesh), CoincidentVertices::kKeepApart);
  EXPECT_EQ(apart.component_count, 2);
  EXPECT_EQ(apart.vertexCount(), 40);
}

TEST(ExtractRegion, RefusesEmptyForeignAndNonFinite) {
  TriangleMesh mesh = test::makeSheet(4, 3);
  EXPECT_THROW(extractRegion(mesh, std::vector<int>{}), InputError);
  EXPECT_THROW(extractRegion(mesh, std::vector<int>{-1, 2}), InputError);
  EXPECT_THROW(extractRegion(mesh, std::vector<int>{2, 12}), InputError);
  mesh.positions(11, 2) = std::numeric_limits<double>::infinity();
  EXPECT_NO_THROW(extractRegion(mesh, std::vector<int>{0}));
  EXPECT_THROW(test::wholeRegion(mesh), InputError);
}

}  // namespace
}  // namespace facezip::geometry
