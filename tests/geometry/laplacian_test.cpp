#include "facezip/geometry/laplacian.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "../reference/mask_weights.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

std::vector<std::array<int, 3>> trianglesOf(const RegionMesh& region) {
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : region.triangles.rowwise()) triangles.push_back({t[0], t[1], t[2]});
  return triangles;
}

TEST(CombinatorialLaplacian, EqualsTheDenseReference) {
  for (const TriangleMesh& mesh : {test::makeSheet(5, 4), test::makeDamagedSheet()}) {
    const RegionMesh region = test::wholeRegion(mesh);
    const Eigen::MatrixXd laplacian = combinatorialLaplacian(region);
    const auto count = static_cast<std::size_t>(region.vertexCount());
    const reference::Matrix expected = reference::combinatorialLaplacian(count, trianglesOf(region));
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        EXPECT_EQ(laplacian(static_cast<int>(i), static_cast<int>(j)), expected[i][j]) << i << ' ' << j;
      }
    }
  }
}

TEST(CombinatorialLaplacian, ConstantsAreItsNullSpaceExactly) {
  const RegionMesh region = test::wholeRegion(test::makeDamagedSheet());
  const Eigen::SparseMatrix<double> laplacian = combinatorialLaplacian(region);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(region.vertexCount());
  EXPECT_EQ((laplacian * ones).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ((Eigen::MatrixXd(laplacian) - Eigen::MatrixXd(laplacian).transpose()).cwiseAbs().maxCoeff(), 0);
}

TEST(CombinatorialLaplacian, PositionsDoNotMatter) {
  TriangleMesh mesh = test::makeSheet(5, 4);
  const Eigen::MatrixXd expected = combinatorialLaplacian(test::wholeRegion(mesh));
  for (const double scale : {1e8, 1e-8}) {
    TriangleMesh scaled = mesh;
    scaled.positions *= scale;
    EXPECT_EQ(Eigen::MatrixXd(combinatorialLaplacian(test::wholeRegion(scaled))), expected);
  }
}

}  // namespace
}  // namespace facezip::geometry
