#include "search/centred_gram.hpp"

#include <algorithm>
#include <cassert>

namespace facezip::compress {

double packCentredGram(const Eigen::Ref<const GramMatrices::Matrix>& gram, OriginRow origin, int padded,
                       std::span<float> out) {
  const Eigen::Index n = gram.rows();
  const Eigen::Index rows = n + (origin == OriginRow::kWith ? 1 : 0);
  assert(gram.cols() == n && rows <= padded && out.size() == toSize(padded) * padded);
  std::fill(out.begin(), out.end(), 0.0f);
  if (n == 0) return 0.0;

  // The origin is a fragment whose inner products are all zero; it is not part of the mean.
  GramMatrices::Matrix centred = GramMatrices::Matrix::Zero(rows, rows);
  centred.topLeftCorner(n, n) = gram;
  const Eigen::VectorXd row_means = centred.leftCols(n).rowwise().sum() / static_cast<double>(n);
  const double mean = row_means.head(n).sum() / static_cast<double>(n);
  const double longest = gram.diagonal().maxCoeff();
  centred = (centred.colwise() - row_means).rowwise() - row_means.transpose();
  centred.array() += mean;

  constexpr double kRounding = 1e-12;
  const double scale = centred.diagonal().maxCoeff();
  if (!(scale > kRounding * longest)) return 0.0;
  using FloatMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<FloatMatrix>(out.data(), padded, padded).topLeftCorner(rows, rows) = (centred / scale).cast<float>();
  return scale;
}

}  // namespace facezip::compress
