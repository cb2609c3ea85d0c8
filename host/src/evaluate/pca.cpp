#include "evaluate/pca.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "bands/band_differences.hpp"
#include "bands/covered_texels.hpp"

namespace facezip::evaluate {

std::vector<double> pcaSquaredErrors(const Eigen::MatrixXd& gram, int components) {
  const Eigen::Index count = gram.rows();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);  // eigenvalues ascending
  const Eigen::Index kept = std::min<Eigen::Index>(components, count);
  const auto values = solver.eigenvalues().tail(kept).array();
  const auto vectors = solver.eigenvectors().rightCols(kept).array();
  const Eigen::ArrayXd explained = (vectors.square().rowwise() * values.transpose()).rowwise().sum();
  std::vector<double> errors(static_cast<std::size_t>(count));
  for (Eigen::Index n = 0; n < count; ++n) {
    errors[static_cast<std::size_t>(n)] = std::max(0.0, gram(n, n) - explained(n));  // rounding may pass below zero
  }
  return errors;
}

Eigen::MatrixXd pcaProjector(const Eigen::MatrixXd& gram, int components) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  const Eigen::MatrixXd vectors = solver.eigenvectors().rightCols(std::min<Eigen::Index>(components, gram.rows()));
  return vectors * vectors.transpose();
}

Eigen::MatrixXf pcaTexelErrors(std::span<const std::byte> samples, const compress::BandShape& shape,
                               std::span<const std::uint32_t> texels, const Eigen::MatrixXd& projector) {
  const Eigen::Index channels = shape.channels;
  const Eigen::MatrixXf left =
      Eigen::MatrixXf::Identity(shape.expressions, shape.expressions) - projector.cast<float>();
  Eigen::MatrixXf errors(static_cast<Eigen::Index>(texels.size()), shape.expressions);
  constexpr std::size_t kRows = 1024;  // a few hundred KB of differences: they stay in the cache
  tbb::parallel_for(std::size_t{0}, (texels.size() + kRows - 1) / kRows, [&](std::size_t chunk) {
    const std::size_t begin = chunk * kRows;
    const std::size_t count = std::min(kRows, texels.size() - begin);
    const Eigen::MatrixXf residual = compress::gatherDifferences(samples, shape, texels.subspan(begin, count)) * left;
    for (Eigen::Index n = 0; n < residual.cols(); ++n) {
      const Eigen::Map<const Eigen::MatrixXf> by_texel(residual.col(n).data(), channels,
                                                       static_cast<Eigen::Index>(count));
      errors.col(n).segment(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(count)) =
          (by_texel.colwise().squaredNorm() / static_cast<float>(channels)).cwiseSqrt().transpose();
    }
  });
  return errors;
}

}  // namespace facezip::evaluate
