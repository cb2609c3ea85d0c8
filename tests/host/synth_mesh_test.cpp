// The built-in head: its mesh, its expressions, its chart.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>
#include <set>

#include "synth/chart_raster.hpp"
#include "synth/expressions.hpp"
#include "synth/head_mesh.hpp"
#include "synth/noise.hpp"

namespace facezip {
namespace {

class SynthMesh : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, SynthMesh, testing::Values(1, 2, 3));

double uvArea(const geometry::TriangleMesh& mesh, Eigen::Index f) {
  const Eigen::RowVector2d a = mesh.uvs.row(mesh.uv_triangles(f, 0));
  const Eigen::RowVector2d ab = mesh.uvs.row(mesh.uv_triangles(f, 1)) - a;
  const Eigen::RowVector2d ac = mesh.uvs.row(mesh.uv_triangles(f, 2)) - a;
  return 0.5 * (ab.x() * ac.y() - ab.y() * ac.x());
}

/// Boundary edges as a map from the start of each to its end.
std::map<int, int> boundaryOf(const Eigen::MatrixX3i& triangles) {
  std::set<std::pair<int, int>> edges;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k) edges.insert({triangles(f, k), triangles(f, (k + 1) % 3)});
  }
  EXPECT_EQ(edges.size(), static_cast<std::size_t>(3 * triangles.rows())) << "an edge has two triangles on one side";
  std::map<int, int> boundary;
  for (const auto& [from, to] : edges) {
    if (!edges.contains({to, from})) {
      EXPECT_TRUE(boundary.emplace(from, to).second) << "two borders meet in a vertex";
    }
  }
  return boundary;
}

int loopCount(const std::map<int, int>& boundary) {
  std::set<int> seen;
  int loops = 0;
  for (const auto& [from, to] : boundary) {
    if (!seen.insert(from).second) continue;
    for (int v = to; v != from; v = boundary.at(v)) seen.insert(v);
    ++loops;
  }
  return loops;
}

TEST_P(SynthMesh, MeshIsOneChartWithAnOutlineAndThreeHoles) {
  const synth::HeadMesh head{synth::HeadShape(GetParam())};
  const geometry::TriangleMesh& mesh = head.mesh;
  EXPECT_EQ(mesh.triangles.rows(), 20000);
  const std::map<int, int> boundary = boundaryOf(mesh.triangles);
  EXPECT_EQ(loopCount(boundary), 4);
  // Euler characteristic of one disk with three holes: 1 - 3.
  const auto edges = (3 * mesh.triangles.rows() + static_cast<Eigen::Index>(boundary.size())) / 2;
  EXPECT_EQ(mesh.positions.rows() - edges + mesh.triangles.rows(), -2);
}

TEST_P(SynthMesh, TrianglesAreSoundInSpaceAndInTheChart) {
  const synth::HeadMesh head{synth::HeadShape(GetParam())};
  const geometry::TriangleMesh& mesh = head.mesh;
  EXPECT_GT(mesh.uvs.minCoeff(), 0.015);
  EXPECT_LT(mesh.uvs.maxCoeff(), 0.985);
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    const Eigen::RowVector3d a = mesh.positions.row(mesh.triangles(f, 0));
    const Eigen::RowVector3d ab = mesh.positions.row(mesh.triangles(f, 1)) - a;
    const Eigen::RowVector3d ac = mesh.positions.row(mesh.triangles(f, 2)) - a;
    const double longest = std::max({ab.norm(), ac.norm(), (ab - ac).norm()});
    ASSERT_GT(uvArea(mesh, f), 1e-8) << "triangle " << f;
    ASSERT_GT(ab.cross(ac).norm(), 0.02 * longest * longest) << "triangle " << f;
    ASSERT_LT(longest, 0.015) << "triangle " << f;
  }
}

TEST(SynthChart, IsHeadSizedInMetres) {
  const synth::HeadMesh head{synth::HeadShape(1)};
  const Eigen::RowVector3d size = head.mesh.positions.colwise().maxCoeff() - head.mesh.positions.colwise().minCoeff();
  EXPECT_NEAR(size.x(), 0.16, 0.02);
  EXPECT_NEAR(size.y(), 0.24, 0.02);
  EXPECT_GT(size.z(), 0.08);
}

TEST(SynthChart, ChartDoesNotOverlapItself) {
  const synth::HeadMesh head{synth::HeadShape(1)};
  const geometry::TriangleMesh& mesh = head.mesh;
  synth::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::RowVector2d point(random.uniform(), random.uniform());
    int triangles = 0;
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
      bool inside = true;
      for (int k = 0; k < 3 && inside; ++k) {
        const Eigen::RowVector2d from = mesh.uvs.row(mesh.triangles(f, k));
        const Eigen::RowVector2d along = mesh.uvs.row(mesh.triangles(f, (k + 1) % 3)) - from;
        inside = along.x() * (point.y() - from.y()) - along.y() * (point.x() - from.x()) > 0.0;
      }
      triangles += inside ? 1 : 0;
    }
    ASSERT_LE(triangles, 1) << point;
  }
}

// ---- expressions

TEST_P(SynthMesh, EveryExpressionHasANameOfItsOwnAndMovesTheMesh) {
  const synth::HeadShape shape(GetParam());
  const synth::HeadMesh head(shape);
  std::set<std::string> names;
  for (const synth::Expression& expression : synth::makeExpressions(100, GetParam())) {
    EXPECT_TRUE(names.insert(expression.name).second) << expression.name;
    const Eigen::MatrixX3d positions = synth::deform(head, shape, expression.actions, expression.take);
    ASSERT_TRUE(positions.allFinite()) << expression.name;
    const double furthest = (positions - head.mesh.positions).rowwise().norm().maxCoeff();
    EXPECT_GT(furthest, 0.001) << expression.name;
    EXPECT_LT(furthest, 0.060) << expression.name;
  }
  EXPECT_EQ(names.size(), 100u);
}

TEST(SynthExpressions, FirstTwentyAreTheClassicalOnes) {
  const auto expressions = synth::makeExpressions(20, 1);
  EXPECT_EQ(expressions.front().name, "jaw_open_wide");
  EXPECT_EQ(expressions[2].name, "smile_open");
  EXPECT_EQ(expressions.back().name, "jaw_forward_chin_raise");
}

TEST(SynthExpressions, LeaveTheRestOfTheFaceExactlyStill) {
  const synth::HeadShape shape(1);
  const synth::HeadMesh head(shape);
  const auto expressions = synth::makeExpressions(20, 1);
  const auto frown =
      std::find_if(expressions.begin(), expressions.end(), [](const auto& e) { return e.name == "frown_brow"; });
  const Eigen::MatrixX3d moved = synth::deform(head, shape, frown->actions, frown->take) - head.mesh.positions;
  for (std::size_t v = 0; v < head.skin.size(); ++v) {
    if (head.skin[v].t < 0.03) {
      ASSERT_EQ(moved.row(static_cast<Eigen::Index>(v)).norm(), 0.0) << "vertex " << v;
    }
  }
}

// ---- the raster

TEST(SynthRaster, CoveredTexelsAreWhereTheyShouldBe) {
  const synth::HeadMesh head{synth::HeadShape(2)};
  constexpr int kResolution = 137;
  const synth::ChartRaster raster(head.mesh, kResolution);
  int inside = 0;
  std::vector<synth::MeshPoint> points(kResolution);
  for (int row = 0; row < kResolution; ++row) {
    raster.rasteriseRow(row, points);
    for (int x = 0; x < kResolution; ++x) {
      const synth::MeshPoint& point = points[static_cast<std::size_t>(x)];
      ASSERT_GE(point.triangle, 0);
      const auto uv = [&](int k) {
        return Eigen::RowVector2d(head.mesh.uvs.row(head.mesh.triangles(point.triangle, k)));
      };
      const double b1 = point.b1, b2 = point.b2;
      ASSERT_GE(std::min({b1, b2, 1.0 - b1 - b2}), -1e-4);
      const Eigen::RowVector2d shown = (1.0 - b1 - b2) * uv(0) + b1 * uv(1) + b2 * uv(2);
      const Eigen::RowVector2d centre((x + 0.5) / kResolution, 1.0 - (row + 0.5) / kResolution);
      inside += (shown - centre).norm() < 1e-5 ? 1 : 0;
    }
  }
  double area = 0.0;
  for (Eigen::Index f = 0; f < head.mesh.triangles.rows(); ++f) area += uvArea(head.mesh, f);
  EXPECT_NEAR(inside, area * kResolution * kResolution, 0.005 * area * kResolution * kResolution);
}

}  // namespace
}  // namespace facezip
