#include "evaluate/pca.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <random>

namespace facezip {
namespace {

Eigen::MatrixXd randomDifferences(int texels, int expressions) {
  std::mt19937_64 random(7);
  Eigen::MatrixXd differences(texels, expressions);
  for (Eigen::Index i = 0; i < differences.size(); ++i) {
    differences.data()[i] = static_cast<double>(random() % 2001) / 1000.0 - 1.0;
  }
  return differences;
}

TEST(Pca, GramGivesTheResidualsOfASingularValueDecomposition) {
  const Eigen::MatrixXd differences = randomDifferences(500, 9);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(differences, Eigen::ComputeThinU);
  for (const int components : {0, 1, 4, 8, 9, 20}) {
    const int kept = std::min(components, 9);
    const Eigen::MatrixXd basis = svd.matrixU().leftCols(kept);
    const Eigen::MatrixXd residual = differences - basis * (basis.transpose() * differences);
    const auto errors = evaluate::pcaSquaredErrors(differences.transpose() * differences, components);
    ASSERT_EQ(errors.size(), 9u);
    for (int n = 0; n < 9; ++n) EXPECT_NEAR(errors[static_cast<std::size_t>(n)], residual.col(n).squaredNorm(), 1e-9);
  }
}

}  // namespace
}  // namespace facezip
