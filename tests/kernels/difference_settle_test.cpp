#include "problems/difference_settle.hpp"

#include <gtest/gtest.h>

#include "grid_sizes.hpp"
#include "reference/difference_settle.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

class DifferenceSettle : public GridTest {};

TEST_P(DifferenceSettle, DecodesAndMeasuresWhatIsLeft) {
  for (const device::KernelVariant variant : variants()) {
    auto problem = scattered<DifferenceSettleProblem>(GetParam(), variant);
    problem.run();
    const std::vector<float> textures = problem.result();
    for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
      std::array<double, 2> expected = {0.0, 0.0};
      double energy = 0.0;
      for (int t = 0; t < kTileTexels; ++t) {
        const Eigen::MatrixXd d = problem.decoded(problem.given, tile, t);
        ASSERT_LE((problem.textureOf(textures, tile, t) - d).cwiseAbs().maxCoeff(), 1e-5 * problem.fullScale());
        if (problem.texelWeight(tile, t) == 0.0) continue;
        const Eigen::MatrixXd w = problem.weightsOf(tile, t);
        const double error = reference::settledError(w, problem.deltaOf(tile, t), d);
        expected[0] += error * problem.texelWeight(tile, t);
        expected[1] += error;
        energy += problem.deltaOf(tile, t).squaredNorm() + (w.transpose() * d).squaredNorm();
      }
      const std::array<double, 2> errors = problem.errorOf(tile);
      for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(errors[k], expected[k], 10.0 * kFitErrorRelative * energy);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceSettle,
                         testing::Values(kGridSizes[0], kGridSizes[2], kGridSizes[3], kGridSizes[4], kGridSizes[7],
                                         kOneTexture));

}  // namespace
}  // namespace facezip::test
