#include "problems/half_cell_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "grid_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

class HalfCellFit : public HalfCellTest {};

TEST_P(HalfCellFit, EqualsReference) {
  auto problem = scattered<HalfCellFitProblem>(GetParam());
  problem.run();
  const std::vector<float> halves = problem.result();
  const auto at = [&](int y, int x, int entry) {
    return static_cast<double>(halves[problem.halfLayout()(y, x, entry)]);
  };
  double error = 0.0;
  double energy = 0.0;
  const compress::WindowRows& rows = problem.window.rows();
  for (int y = 0; y < problem.halves.rows().count; ++y) {
    const int half_row = problem.halves.rows().first + y;
    for (int x = 0; x < 2 * problem.space.columns; ++x) {
      const reference::HalfCellFit fit = problem.expected(half_row, x);
      // What rounding does to the solution grows with the condition of the system.
      const double condition =
          std::max(1.0, problem.weightsAt(half_row, x).squaredNorm() / static_cast<double>(problem.ridge));
      const double deltas = problem.deltas(half_row, x).squaredNorm();
      const double tolerance = kSolveRelative * condition * (1.0 + deltas + fit.block.norm());
      for (int i = 0; i < problem.space.textures; ++i) {
        for (int j = 0; j <= i; ++j) {
          ASSERT_NEAR(at(y, x, i * (i + 1) / 2 + j), fit.block(i, j), tolerance) << y << " " << x;
        }
        for (int n = 0; n < problem.space.expressions; ++n) {
          ASSERT_NEAR(at(y, x, problem.sideEntry(i, n)), fit.sides(i, n), tolerance) << y << " " << x;
        }
      }
      if (half_row < 2 * rows.free_begin || half_row >= 2 * rows.free_end) continue;
      error += fit.error;
      energy += deltas;
    }
  }
  EXPECT_NEAR(problem.halves.error(), error, 10.0 * kFitErrorRelative * energy);
}

TEST_P(HalfCellFit, BlocksStayPositiveWhereTwoTexturesShareTheirWeights) {
  auto problem = scattered<HalfCellFitProblem>(GetParam());
  problem.ridge = 1e-4f;  // magnifies what rounding leaves along their difference
  const int c = problem.space.textures;
  if (c < 2) GTEST_SKIP() << "one texture";
  std::vector<float> weights = problem.window.weights();
  const std::size_t lanes = problem.space.lanes();
  for (std::size_t cell = 0; cell < weights.size(); cell += problem.space.cellFloats()) {
    for (std::size_t n = 0; n < lanes; ++n) weights[cell + lanes + n] = weights[cell + n];
  }
  problem.window.set(problem.window.rows(), weights, weights);
  problem.run();
  const std::vector<float> halves = problem.result();
  for (int y = 0; y < problem.halves.rows().count; ++y) {
    for (int x = 0; x < problem.halves.rows().columns(); ++x) {
      Eigen::MatrixXd block(c, c);
      for (int i = 0; i < c; ++i) {
        for (int j = 0; j <= i; ++j) {
          block(i, j) = block(j, i) = static_cast<double>(halves[problem.halfLayout()(y, x, i * (i + 1) / 2 + j)]);
        }
      }
      const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(block).eigenvalues();
      ASSERT_GE(values.minCoeff(), -kSolveRelative * values.maxCoeff()) << y << " " << x;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, HalfCellFit, testing::ValuesIn(kGridSizes));
INSTANTIATE_TEST_SUITE_P(OneTexture, HalfCellFit, testing::Values(kOneTexture));

}  // namespace
}  // namespace facezip::test
