// The whole search: clusters, seams, permutation, and what Eq. 5 and 6 make of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "search/permutation_search.hpp"
#include "search/texture_assignment.hpp"
#include "search_capture.hpp"
#include "test_device.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using compress::Clustering;
using compress::GramMatrices;
using compress::Permutation;
using compress::SeamTables;

/// Largest |sum_i D_i W_in - Delta_n| over texels and expressions, with Eq. 5 and 6 from the search's own results.
double reconstructionError(const SearchCapture& capture) {
  const GramMatrices grams = gramsOf(capture);
  const Clustering clustering = clusterFragments(testDevice(), grams, {.restarts = 16});
  const SeamTables tables = computeSeamTables(testDevice(), grams, clustering);
  const Permutation permutation = searchPermutation(tables, {.restarts = 100}).best;
  const std::vector<float> coefficients = differenceCoefficients(clustering, permutation);
  const std::vector<int> textures = textureOfExpression(clustering, permutation);
  const std::size_t n_count = capture.differences.size(), masks = capture.masks.size();
  double worst = 0.0;
  for (std::size_t p = 0; p < capture.texels(); ++p) {
    double d[4] = {};
    for (std::size_t k = 0; k < masks; ++k) {
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t n = 0; n < n_count; ++n) {
          const double coefficient = static_cast<double>(coefficients[(k * 4 + i) * n_count + n]);
          d[i] += capture.masks[k][p] * coefficient * capture.differences[n][p];
        }
      }
    }
    for (std::size_t n = 0; n < n_count; ++n) {
      double sum = 0.0;
      for (std::size_t k = 0; k < masks; ++k) {
        sum += capture.masks[k][p] * d[static_cast<std::size_t>(textures[k * n_count + n])];
      }
      worst = std::max(worst, std::abs(sum - capture.differences[n][p]));
    }
  }
  return worst;
}

// Issue of sigma against sigma^-1 in Eq. 6: only the right reading reproduces these.
TEST(Search, FourExpressionsOrFewerAreReproducedExactly) {
  for (const int expressions : {1, 2, 3, 4}) {
    SCOPED_TRACE(expressions);
    EXPECT_LT(reconstructionError(randomCapture(expressions, 7, 5, Masks::kHard)), 100.0 * kExactReconstruction);
    // Across soft seams as well: the search finds the permutation in which every texture is one expression all over.
    EXPECT_LT(reconstructionError(randomCapture(expressions, 7, 5, Masks::kSoft)), 100.0 * kExactReconstruction);
  }
}

TEST(Search, RepeatsOfFourExpressionsAreReproducedExactly) {
  for (const Masks kind : {Masks::kHard, Masks::kSoft}) {
    SearchCapture capture = randomCapture(4, 7, 5, kind);
    for (std::size_t n = 4; n < 11; ++n) capture.differences.push_back(capture.differences[n * n % 4]);
    EXPECT_LT(reconstructionError(capture), 100.0 * kExactReconstruction);
  }
  EXPECT_GT(reconstructionError(randomCapture(5, 7, 5)), 1.0);  // five are too many: the test can fail
}

}  // namespace
}  // namespace facezip::test
