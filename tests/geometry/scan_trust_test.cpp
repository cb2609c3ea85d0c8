#include "facezip/geometry/scan_trust.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "facezip/geometry/mesh_edges.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

TEST(ScanTrust, PutsSpikesBackAndLeavesTheRest) {
  const TriangleMesh clean = test::makeSheet(20, 20);
  Eigen::MatrixX3d scanned = clean.positions;
  for (Eigen::Index v = 0; v < scanned.rows(); ++v) scanned(v, 2) += 0.01 * std::sin(13.7 * static_cast<double>(v));
  const Eigen::MatrixX3d noisy = scanned;
  for (const int spike : {45, 130, 210, 333}) scanned(spike, 2) += 1.5;
  const TrustedScan scan = judgeScan(scanned, clean.triangles);
  EXPECT_EQ(scan.spikes, 4);
  for (const int spike : {45, 130, 210, 333}) {
    EXPECT_LT((scan.positions.row(spike) - noisy.row(spike)).norm(), 0.5);
  }
  int moved = 0;
  for (Eigen::Index v = 0; v < scanned.rows(); ++v) moved += scan.positions.row(v) != scanned.row(v) ? 1 : 0;
  EXPECT_EQ(moved, 4);
}

TEST(ScanTrust, KnowsTheNoise) {
  const TriangleMesh clean = test::makeSheet(30, 30);
  Eigen::MatrixX3d flat = clean.positions;
  flat.col(2).setZero();
  EXPECT_LT(judgeScan(flat, clean.triangles).roughness, 1e-9);
  for (Eigen::Index v = 0; v < flat.rows(); ++v) flat(v, 2) = 0.02 * std::sin(17.3 * static_cast<double>(v * v % 997));
  const double roughness = judgeScan(flat, clean.triangles).roughness;
  EXPECT_GT(roughness, 0.005);
  EXPECT_LT(roughness, 0.05);
}

TEST(ScanTrust, DistrustsLongTriangles) {
  TriangleMesh mesh = test::makeSheet(12, 12);
  test::addTriangle(mesh, 0, 11, 140);  // a web from corner to corner
  const TrustedScan scan = judgeScan(mesh.positions, mesh.triangles);
  EXPECT_EQ(scan.trust.back(), 0.0f);
  for (std::size_t t = 0; t + 1 < scan.trust.size(); ++t) EXPECT_EQ(scan.trust[t], 1.0f);
}

}  // namespace
}  // namespace facezip::geometry
