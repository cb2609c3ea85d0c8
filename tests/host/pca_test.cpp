#include "evaluate/pca.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cstring>
#include <numeric>
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

TEST(Pca, ProjectorLeavesTheSameErrorsTexelByTexel) {
  // Three textures of 40 texels of two channels: float samples, the neutral at zero.
  const compress::BandShape shape{10, 4, 2, 3, image::SampleType::kFloat32};
  const Eigen::MatrixXf differences = randomDifferences(80, 3).cast<float>();
  std::vector<float> samples(80, 0.0f);
  samples.insert(samples.end(), differences.data(), differences.data() + differences.size());
  std::vector<std::byte> bytes(samples.size() * sizeof(float));
  std::memcpy(bytes.data(), samples.data(), bytes.size());
  std::vector<std::uint32_t> texels(40);
  std::iota(texels.begin(), texels.end(), 0u);
  const Eigen::MatrixXd gram = 255.0 * 255.0 * (differences.transpose() * differences).cast<double>();
  for (const int components : {0, 1, 2, 3}) {
    const Eigen::MatrixXf errors =
        evaluate::pcaTexelErrors(bytes, shape, texels, evaluate::pcaProjector(gram, components));
    const auto expected = evaluate::pcaSquaredErrors(gram, components);
    for (int n = 0; n < 3; ++n) {
      EXPECT_NEAR(2.0f * errors.col(n).squaredNorm(), expected[static_cast<std::size_t>(n)], 1e-4 * gram(n, n));
    }
  }
}

}  // namespace
}  // namespace facezip
