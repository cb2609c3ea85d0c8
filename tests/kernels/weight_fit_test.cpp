// Both halves of the alternating least squares: difference textures under given weights, weights under given textures.
#include "reference/weight_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "compress/refine/refinement.hpp"
#include "grid_problem.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

using image::SampleType;

class WeightFit : public testing::TestWithParam<GridCase> {
 protected:
  void SetUp() override {
    const BandShape& shape = GetParam().shape;
    if (test::smallSizesOnly() && (GetParam().textures > 2 || shape.expressions * shape.width * shape.rows > 1100))
      GTEST_SKIP() << "small sizes only";
  }
};

TEST_P(WeightFit, DifferenceTexturesSolveEveryTexel) {
  for (const device::KernelVariant variant : variants()) {
    GridProblem problem(GetParam(), variant);
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    const std::vector<float> textures = problem.readTextures();
    const std::vector<FitError> errors = problem.fit_.errors();
    const double full_scale = problem.shape_.sample_type == SampleType::kFloat32 ? 510.0 : 255.0;
    for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
      double weighted = 0.0;
      double plain = 0.0;
      double energy = 0.0;
      for (int t = 0; t < 256; ++t) {
        const Eigen::MatrixXd w = problem.weights_.texel(problem.x(tile, t), problem.y(tile, t));
        const Eigen::MatrixXd delta = problem.delta(tile, t);
        const Eigen::MatrixXd d = reference::fitDifference(w, delta, static_cast<double>(kRidge));
        // What rounding does to the solution grows with the condition of the system.
        const double condition = w.squaredNorm() / static_cast<double>(kRidge);
        for (int i = 0; i < problem.which_.textures; ++i) {
          for (int c = 0; c < problem.shape_.channels; ++c) {
            const double actual = static_cast<double>(textures[problem.textureIndex(tile, i, c, t)]);
            const double expected = problem.wanted(tile, t) ? d(i, c) : 0.0;
            ASSERT_NEAR(actual, expected, test::kSolveRelative * condition * full_scale) << tile << " " << t;
          }
        }
        if (problem.texelWeight(tile, t) == 0.0f) continue;
        const double error = (delta - w.transpose() * d).squaredNorm();
        weighted += error * static_cast<double>(problem.texelWeight(tile, t));
        plain += error;
        energy += delta.squaredNorm();
      }
      EXPECT_NEAR(errors[tile].weighted, weighted, test::kFitErrorRelative * energy);
      EXPECT_NEAR(errors[tile].plain, plain, test::kFitErrorRelative * energy);
    }
  }
}

// What the host uploads for a band are the cells that cellRowsOf() tells.
TEST_P(WeightFit, DifferenceTexturesTouchNoCellsBeyondTheBand) {
  const GridCase& which = GetParam();
  for (const device::KernelVariant variant : variants()) {
    GridProblem problem(which, variant);
    const WindowRows rows = problem.window_.rows();
    const WindowRows held =
        cellRowsOf(which.first_row, which.first_row + which.shape.rows, which.weight_scale, problem.space_.rows);
    std::vector<float> weights = problem.window_.weights();
    const auto row_begin = [&](int row) {
      return weights.begin() + (row - rows.begin) * static_cast<std::ptrdiff_t>(problem.space_.rowFloats());
    };
    std::fill(weights.begin(), row_begin(held.begin), std::numeric_limits<float>::quiet_NaN());
    std::fill(row_begin(std::min(held.end, rows.end)), weights.end(), std::numeric_limits<float>::quiet_NaN());
    problem.window_.set(rows, weights, weights);
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    for (const float value : problem.readTextures()) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST_P(WeightFit, RoundedTexturesAreCodesAndNearlyAsGood) {
  GridProblem problem(GetParam());
  const auto planes = static_cast<std::size_t>(problem.which_.textures * problem.shape_.channels);
  problem.fit_.compute(problem.band(), problem.window_, kRidge);
  std::vector<float> exact = problem.readTextures();
  std::vector<TextureEncoding> encoding;
  for (std::size_t plane = 0; plane < planes; ++plane) encoding.push_back(encodingFor({-300.0f, 200.0f}, 8));
  problem.fit_.computeRounded(problem.band(), problem.window_, kRidge, encoding, 8);
  const std::vector<float> rounded = problem.readTextures();
  const std::vector<FitError> errors = problem.fit_.errors();
  double at_once = 0.0;  // error of rounding each channel for itself
  double in_turn = 0.0;
  for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
    double plain = 0.0;
    double energy = 0.0;
    for (int t = 0; t < 256; ++t) {
      Eigen::MatrixXd d(problem.which_.textures, problem.shape_.channels);
      Eigen::MatrixXd naive = d;
      for (int i = 0; i < problem.which_.textures; ++i) {
        for (int c = 0; c < problem.shape_.channels; ++c) {
          const TextureEncoding& e = encoding[static_cast<std::size_t>(i * problem.shape_.channels + c)];
          const float value = rounded[problem.textureIndex(tile, i, c, t)];
          const float code = (value - e.offset) / e.scale;
          ASSERT_EQ(value, e.scale * std::round(code) + e.offset);
          ASSERT_GE(code, 0.0f);
          ASSERT_LE(code, 255.0f);
          d(i, c) = static_cast<double>(value);
          naive(i, c) = static_cast<double>(
              e.scale * std::clamp(std::round((exact[problem.textureIndex(tile, i, c, t)] - e.offset) / e.scale), 0.0f,
                                   255.0f) +
              e.offset);
        }
      }
      if (problem.texelWeight(tile, t) == 0.0f) continue;
      const Eigen::MatrixXd w = problem.weights_.texel(problem.x(tile, t), problem.y(tile, t));
      const Eigen::MatrixXd delta = problem.delta(tile, t);
      plain += (delta - w.transpose() * d).squaredNorm();
      at_once += (delta - w.transpose() * naive).squaredNorm();
      energy += delta.squaredNorm() + (w.transpose() * d).squaredNorm();
    }
    in_turn += plain;
    EXPECT_NEAR(errors[tile].plain, plain, test::kFitErrorRelative * energy);
  }
  EXPECT_LE(in_turn, at_once * (1.0 + 1e-6));
}

TEST_P(WeightFit, SystemEqualsReference) {
  for (const device::KernelVariant variant : variants()) {
    GridProblem problem(GetParam(), variant);
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    problem.addToSystem(1.0);
    problem.addToSystem(0.5);
    const std::vector<reference::FitTexel> texels = problem.texels(problem.readTextures());
    const WindowRows& rows = problem.window_.rows();
    const std::size_t entries = problem.space_.systemEntries();
    std::vector<float> system(static_cast<std::size_t>(rows.count() * problem.space_.columns) * entries);
    GridProblem::context().read(problem.system_.equations(), system, "system");
    const int c = problem.which_.textures;
    const std::size_t side_begin = entries - problem.space_.cellFloats();
    for (int row = rows.begin; row < rows.end; ++row) {
      for (int column = 0; column < problem.space_.columns; ++column) {
        const float* cell =
            system.data() + static_cast<std::size_t>((row - rows.begin) * problem.space_.columns + column) * entries;
        const Eigen::MatrixXd self = reference::systemBlock(problem.weights_, texels, row, column, row, column);
        const double scale = 1.0 + self.trace();
        for (int block = 0; block < 4; ++block) {
          const Eigen::MatrixXd expected =
              reference::systemBlock(problem.weights_, texels, row, column, row + block / 2, column + block % 2);
          for (int i = 0; i < c; ++i) {
            for (int j = 0; j <= i; ++j) {
              ASSERT_NEAR(static_cast<double>(cell[block * c * (c + 1) / 2 + i * (i + 1) / 2 + j]),
                          1.5 * expected(i, j), test::kSystemRelative * scale)
                  << row << " " << column << " block " << block;
            }
          }
        }
        const Eigen::MatrixXd sides = reference::systemSides(problem.weights_, texels, row, column);
        for (int i = 0; i < c; ++i) {
          for (int n = 0; n < problem.space_.expressions; ++n) {
            ASSERT_NEAR(static_cast<double>(cell[side_begin + static_cast<std::size_t>(i) * problem.space_.lanes() +
                                                 static_cast<std::size_t>(n)]),
                        1.5 * sides(i, n), test::kSystemRelative * (scale + sides.norm()));
          }
        }
      }
    }
  }
}

TEST_P(WeightFit, RelaxingMovesEveryFreeCellToItsMinimum) {
  for (const device::KernelVariant variant : variants()) {
    GridProblem problem(GetParam(), variant);
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    problem.addToSystem(1.0);
    const std::vector<reference::FitTexel> texels = problem.texels(problem.readTextures());
    reference::GridWeights expected = problem.weights_;
    const WindowRows& rows = problem.window_.rows();
    constexpr int kSweeps = 2;
    for (int step = 0; step < 4 * kSweeps; ++step) {
      for (int row = rows.free_begin; row < rows.free_end; ++row) {
        if (row % 2 != step / 2 % 2) continue;
        for (int column = step % 2; column < problem.space_.columns; column += 2) {
          reference::relaxCell(expected, problem.weights_, texels, row, column, static_cast<double>(kSmoothness),
                               static_cast<double>(kTrust));
        }
      }
    }
    problem.system_.relax(problem.window_, kSweeps, kSmoothness, kTrust);
    const reference::GridWeights actual = problem.currentWeights();
    for (std::size_t i = 0; i < expected.values.size(); ++i) {
      ASSERT_NEAR(actual.values[i], expected.values[i], test::kRelaxedWeight * (1.0 + std::abs(expected.values[i])))
          << i;
    }
  }
}

TEST_P(WeightFit, EveryHalfStepLowersTheObjective) {
  GridProblem problem(GetParam());
  double last = std::numeric_limits<double>::infinity();
  for (int sweep = 0; sweep < 4; ++sweep) {
    problem.fit_.compute(problem.band(), problem.window_, kRidge);
    const std::vector<reference::FitTexel> texels = problem.texels(problem.readTextures());
    const auto objective = [&] {
      return reference::objective(problem.currentWeights(), problem.weights_, texels, static_cast<double>(kRidge),
                                  static_cast<double>(kSmoothness), static_cast<double>(kTrust));
    };
    const double fitted = objective();
    EXPECT_LE(fitted, last * (1.0 + 1e-6));
    problem.system_.clear();
    problem.addToSystem(1.0);
    problem.system_.relax(problem.window_, 1, kSmoothness, kTrust);
    last = objective();
    EXPECT_LE(last, fitted * (1.0 + 1e-6));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, WeightFit, testing::ValuesIn(kGridCases));
// Row 640 lies on a cell's centre: 10.5 x 61 - 0.5.
INSTANTIATE_TEST_SUITE_P(OddScale, WeightFit,
                         testing::Values(GridCase{{70, 16, 3, 3, SampleType::kUint8}, 61, 2, 640, 9}));
INSTANTIATE_TEST_SUITE_P(CellsOfOddSidesAndFewTexels, WeightFit,
                         testing::Values(GridCase{{20, 18, 2, 3, SampleType::kUint8}, 5, 1, 0, 0},
                                         GridCase{{7, 5, 3, 2, SampleType::kUint8}, 8, 4, 0, 0}));

}  // namespace
}  // namespace facezip::compress
