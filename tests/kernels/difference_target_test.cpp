#include "problems/difference_target.hpp"

#include <gtest/gtest.h>

#include "grid_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

class DifferenceTarget : public GridTest {};

TEST_P(DifferenceTarget, IsTheBestThatTheCodedTexturesLeaveToAskFor) {
  for (const device::KernelVariant variant : variants()) {
    auto problem = scattered<DifferenceTargetProblem>(GetParam(), variant);
    std::vector<float> codes = problem.given;
    for (int i = problem.space.textures - 1; i >= 0; --i) {
      problem.run(i);
      const std::vector<float> now = problem.result();
      for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
        for (int t = 0; t < kTileTexels; ++t) {
          const Eigen::MatrixXd w = problem.weightsOf(tile, t);
          const Eigen::RowVectorXd target =
              reference::textureTarget(w, problem.deltaOf(tile, t), problem.decoded(codes, tile, t), i, problem.ridge);
          const double condition = w.squaredNorm() / static_cast<double>(problem.ridge);
          for (int c = 0; c < problem.shape.channels; ++c) {
            const auto plane = toSize(i * problem.shape.channels + c);
            const double scale = problem.scales[plane];
            const double wanted = problem.wanted(tile, t) && scale > 0.0 ? target[c] / scale : 0.0;
            ASSERT_NEAR(static_cast<double>(now[problem.textureLayout()(tile, plane, t)]),
                        problem.zeros[plane] + wanted,
                        kSolveRelative * condition * (problem.fullScale() + 100.0) / std::max(scale, 0.25))
                << "texture " << i << " tile " << tile << " texel " << t;
          }
        }
      }
      codes = now;  // coded as it was asked for
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceTarget,
                         testing::Values(kGridSizes[0], kGridSizes[2], kGridSizes[3], kGridSizes[4], kGridSizes[7],
                                         kOneTexture));

}  // namespace
}  // namespace facezip::test
