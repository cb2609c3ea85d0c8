#include "register/detail_maps.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "facezip/geometry/face_region.hpp"
#include "small_capture.hpp"

namespace facezip {
namespace {

constexpr int kTexels = 64;
constexpr double kHeight = 0.3, kWave = 0.2;

/// A sheet of 40 mm, seen from above, whose UVs fill a square of the layout.
geometry::TriangleMesh sheet(int side, bool waves) {
  geometry::TriangleMesh mesh = test::gridMesh(side, 0.1);
  for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v) {
    const double x = 40.0 * static_cast<double>(v % side) / (side - 1),
                 y = 40.0 * static_cast<double>(v / side) / (side - 1);
    mesh.positions.row(v) << x, y, waves ? kHeight + kWave * std::sin(x) : 0.0;
  }
  return mesh;
}

registration::DetailMaps detailOf(const geometry::TriangleMesh& mesh) {
  const geometry::TriangleMesh scan = sheet(161, true);
  const geometry::ScanSurface surface(scan.positions, scan.triangles);
  const raster::UvRaster raster(mesh, geometry::wholeMeshRegion(mesh), kTexels, kTexels, 2);
  Progress progress;
  return registration::bakeDetail(raster, mesh, mesh.positions, scan.triangles, surface, progress);
}

TEST(DetailMaps, HoldTheScansHeightsAndNormalsOverTheMesh) {
  const registration::DetailMaps maps = detailOf(sheet(5, false));
  for (int texel : {20, 27, 40}) {
    const double x = 40.0 * ((texel + 0.5) / kTexels - 0.1) / 0.8;
    const auto at = static_cast<std::size_t>(31 * kTexels + texel);
    EXPECT_NEAR(maps.heights[at], kHeight + kWave * std::sin(x), 0.06) << texel;  // the closest point lies beside
    const double slope = kWave * std::cos(x), length = std::hypot(slope, 1.0);
    EXPECT_NEAR(maps.normals[3 * at], -slope / length, 0.06) << texel;
    EXPECT_NEAR(maps.normals[3 * at + 1], 0.0, 0.01) << texel;
    EXPECT_NEAR(maps.normals[3 * at + 2], 1.0 / length, 0.02) << texel;
  }
}

TEST(DetailMaps, FollowTheLayoutThatIsTurned) {
  geometry::TriangleMesh mesh = sheet(5, false);
  // u along y, v along x: mirrored, and the slope along v.
  mesh.uvs.col(0).swap(mesh.uvs.col(1));
  const registration::DetailMaps maps = detailOf(mesh);
  const int row = 27;
  const double x = 40.0 * ((1.0 - (row + 0.5) / kTexels) - 0.1) / 0.8;
  const auto at = static_cast<std::size_t>(row * kTexels + 31);
  const double slope = kWave * std::cos(x), length = std::hypot(slope, 1.0);
  EXPECT_NEAR(maps.normals[3 * at], 0.0, 0.01);
  EXPECT_NEAR(maps.normals[3 * at + 1], -slope / length, 0.06);
}

TEST(DetailMaps, NormalsHaveLengthOneEverywhere) {
  const registration::DetailMaps maps = detailOf(sheet(5, false));
  for (std::size_t i = 0; i < maps.heights.size(); ++i) {
    EXPECT_NEAR(std::hypot(maps.normals[3 * i], maps.normals[3 * i + 1], maps.normals[3 * i + 2]), 1.0, 1e-4);
  }
}

}  // namespace
}  // namespace facezip
