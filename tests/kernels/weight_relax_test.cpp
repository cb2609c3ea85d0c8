#include "problems/weight_relax.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "grid_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

class WeightRelax : public GridTest {};

TEST_P(WeightRelax, MovesEveryFreeCellToItsMinimum) {
  for (const device::KernelVariant variant : variants()) {
    auto problem = scattered<WeightRelaxProblem>(GetParam(), variant);
    const reference::GridWeights expected = problem.expected();
    problem.run();
    const reference::GridWeights actual = problem.currentWeights();
    for (std::size_t i = 0; i < expected.values.size(); ++i) {
      ASSERT_NEAR(actual.values[i], expected.values[i], kRelaxedWeight * (1.0 + std::abs(expected.values[i]))) << i;
    }
  }
}

/// Both halves of the alternating least squares: textures under given weights, weights under given textures.
TEST_P(WeightRelax, EveryHalfTurnLowersTheObjective) {
  auto problem = scattered<WeightRelaxProblem>(GetParam());
  problem.sweeps = 1;
  double last = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < 4; ++turn) {
    problem.DifferenceFitProblem::run();
    const std::vector<reference::FitTexel> texels = problem.fitTexels(problem.DifferenceFitProblem::result());
    const auto objective = [&] {
      return reference::objective(problem.currentWeights(), problem.weights, texels, static_cast<double>(problem.ridge),
                                  static_cast<double>(problem.smoothness), static_cast<double>(problem.trust));
    };
    const double fitted = objective();
    EXPECT_LE(fitted, last * (1.0 + 1e-6));
    problem.system.clear();
    problem.system.add(problem.band(), problem.tile_at, problem.fit.textures(), problem.window, 1.0);
    problem.run();
    last = objective();
    EXPECT_LE(last, fitted * (1.0 + 1e-6));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, WeightRelax, testing::ValuesIn(kGridSizes));
INSTANTIATE_TEST_SUITE_P(Odd, WeightRelax, testing::ValuesIn(kOddSizes));

}  // namespace
}  // namespace facezip::test
