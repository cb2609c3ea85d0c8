#include "problems/half_cell_gram.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "grid_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

class HalfCellGram : public HalfCellTest {};

TEST_P(HalfCellGram, EqualsReference) {
  auto problem = scattered<HalfCellGramProblem>(GetParam());
  problem.run();
  problem.addAgain(0.5);
  const std::vector<float> grams = problem.result();
  for (int y = 0; y < problem.halves.rows().count; ++y) {
    for (int x = 0; x < 2 * problem.space.columns; ++x) {
      const Eigen::MatrixXd expected = problem.expectedGram(problem.halves.rows().first + y, x);
      for (int m = 0; m < problem.space.expressions; ++m) {
        for (int n = 0; n <= m; ++n) {
          const std::size_t at = problem.gramLayout()(y, x / FACEZIP_VECTOR, m * (m + 1) / 2 + n, x % FACEZIP_VECTOR);
          ASSERT_NEAR(static_cast<double>(grams[at]), expected(n, m),
                      kFitErrorRelative * (1.0 + std::sqrt(expected(n, n) * expected(m, m))))
              << y << " " << x << ": " << n << " " << m;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, HalfCellGram, testing::ValuesIn(kGridSizes));

}  // namespace
}  // namespace facezip::test
