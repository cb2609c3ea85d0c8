#include "problems/difference_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "grid_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

using compress::FitError;
using compress::TextureEncoding;

class DifferenceFit : public GridTest {};

TEST_P(DifferenceFit, SolvesEveryTexel) {
  for (const device::KernelVariant variant : variants()) {
    auto problem = scattered<DifferenceFitProblem>(GetParam(), variant);
    problem.run();
    const std::vector<float> textures = problem.result();
    const std::vector<FitError> errors = problem.fit.errors();
    for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
      double weighted = 0.0;
      double plain = 0.0;
      double energy = 0.0;
      for (int t = 0; t < kTileTexels; ++t) {
        const Eigen::MatrixXd w = problem.weightsOf(tile, t);
        const Eigen::MatrixXd delta = problem.deltaOf(tile, t);
        const Eigen::MatrixXd d = problem.expected(tile, t);
        const Eigen::MatrixXd expected = problem.wanted(tile, t) ? d : Eigen::MatrixXd::Zero(d.rows(), d.cols());
        // What rounding does to the solution grows with the condition of the system.
        const double condition = w.squaredNorm() / static_cast<double>(problem.ridge);
        ASSERT_LE((problem.textureOf(textures, tile, t) - expected).cwiseAbs().maxCoeff(),
                  kSolveRelative * condition * problem.fullScale())
            << tile << " " << t;
        if (problem.texelWeight(tile, t) == 0.0) continue;
        const double error = (delta - w.transpose() * d).squaredNorm();
        weighted += error * problem.texelWeight(tile, t);
        plain += error;
        energy += delta.squaredNorm();
      }
      EXPECT_NEAR(errors[tile].weighted, weighted, kFitErrorRelative * energy);
      EXPECT_NEAR(errors[tile].plain, plain, kFitErrorRelative * energy);
    }
  }
}

// What the host uploads for a band are the cells that cellRowsOf() tells.
TEST_P(DifferenceFit, TouchesNoCellsBeyondTheBand) {
  for (const device::KernelVariant variant : variants()) {
    auto problem = scattered<DifferenceFitProblem>(GetParam(), variant);
    problem.spoilOtherCells();
    problem.run();
    for (const float value : problem.result()) ASSERT_TRUE(std::isfinite(value));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceFit, testing::ValuesIn(kGridSizes));
INSTANTIATE_TEST_SUITE_P(Odd, DifferenceFit, testing::ValuesIn(kOddSizes));

/// Rounding is a program of its own, but the same for all sizes: a few will do.
class DifferenceFitRounded : public GridTest {};

TEST_P(DifferenceFitRounded, TexturesAreCodesAndNearlyAsGood) {
  auto problem = scattered<DifferenceFitProblem>(GetParam());
  problem.run();
  const std::vector<float> exact = problem.result();
  problem.runRounded();
  const std::vector<float> rounded = problem.result();
  const std::vector<FitError> errors = problem.fit.errors();
  const TextureEncoding e = problem.encoding().front();
  const auto codeOf = [&](double value) { return (static_cast<float>(value) - e.offset) / e.scale; };
  double at_once = 0.0;  // error of rounding each channel for itself
  double in_turn = 0.0;
  for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
    double plain = 0.0;
    double energy = 0.0;
    for (int t = 0; t < kTileTexels; ++t) {
      const Eigen::MatrixXd d = problem.textureOf(rounded, tile, t);
      for (const double value : d.reshaped()) {
        const float code = std::round(codeOf(value));
        ASSERT_EQ(static_cast<float>(value), e.scale * code + e.offset);
        ASSERT_GE(code, 0.0f);
        ASSERT_LE(code, 255.0f);
      }
      if (problem.texelWeight(tile, t) == 0.0) continue;
      const Eigen::MatrixXd naive = problem.textureOf(exact, tile, t).unaryExpr([&](double value) {
        return static_cast<double>(e.scale * std::clamp(std::round(codeOf(value)), 0.0f, 255.0f) + e.offset);
      });
      const Eigen::MatrixXd w = problem.weightsOf(tile, t);
      const Eigen::MatrixXd delta = problem.deltaOf(tile, t);
      plain += (delta - w.transpose() * d).squaredNorm();
      at_once += (delta - w.transpose() * naive).squaredNorm();
      energy += delta.squaredNorm() + (w.transpose() * d).squaredNorm();
    }
    in_turn += plain;
    EXPECT_NEAR(errors[tile].plain, plain, kFitErrorRelative * energy);
  }
  EXPECT_LE(in_turn, at_once * (1.0 + 1e-6));
}

INSTANTIATE_TEST_SUITE_P(Shapes, DifferenceFitRounded,
                         testing::Values(kGridSizes[0], kGridSizes[1], kGridSizes[3], kGridSizes[7]));

}  // namespace
}  // namespace facezip::test
