// The refinement's turns on half cells against the same done texel by texel.
#include "compress/refine/half_cells.hpp"

#include <gtest/gtest.h>

#include "grid_problem.hpp"
#include "reference/half_cells.hpp"
#include "tolerances.hpp"

namespace facezip::compress {
namespace {

using image::SampleType;

constexpr double kSecondMap = 0.5;  // metric weight of the band when it is added again

class HalfCellsTest : public testing::TestWithParam<GridCase> {
 protected:
  void SetUp() override {
    if (test::testDevice().resolve(device::KernelVariant::kAuto) != device::KernelVariant::kCpu)
      GTEST_SKIP() << "on GPUs the turns run on texels";
    const BandShape& shape = GetParam().shape;
    if (test::smallSizesOnly() && (GetParam().textures > 2 || shape.expressions * shape.width * shape.rows > 1100))
      GTEST_SKIP() << "small sizes only";
  }
};

/// The band's half cells with its differences added twice, and the same for the reference.
struct HalfCellProblem : GridProblem {
  explicit HalfCellProblem(const GridCase& which) : GridProblem(which), halves(context(), space_) {
    halves.moveTo(window_.rows());
    halves.add(band(), tile_at_, 1.0);
    halves.add(band(), tile_at_, kSecondMap);
  }

  /// Differences of the texels of half cell (row, column) times the roots of their weights, N x (texels * channels).
  Eigen::MatrixXd deltas(int half_row, int half_column) const {
    const int side = which_.weight_scale / 2;
    Eigen::MatrixXd columns(shape_.expressions, 0);
    for (std::size_t tile = 0; tile < tileCount(); ++tile) {
      for (int t = 0; t < 256; ++t) {
        if (y(tile, t) / side != half_row || x(tile, t) / side != half_column) continue;
        const double weight = (1.0 + kSecondMap) * static_cast<double>(texelWeight(tile, t));
        const Eigen::Index at = columns.cols();
        columns.conservativeResize(Eigen::NoChange, at + shape_.channels);
        columns.rightCols(shape_.channels) = std::sqrt(weight) * delta(tile, t);
      }
    }
    return columns;
  }

  /// Weights at the centre of a half cell, C x N.
  Eigen::MatrixXd weightsAt(int half_row, int half_column) const {
    Eigen::MatrixXd w = Eigen::MatrixXd::Zero(space_.textures, space_.expressions);
    for (int row = std::max(0, half_row / 2 - 1); row < std::min(space_.rows, half_row / 2 + 2); ++row) {
      for (int column = std::max(0, half_column / 2 - 1); column < std::min(space_.columns, half_column / 2 + 2);
           ++column) {
        const double share = reference::halfCellShare(half_row, row, space_.rows) *
                             reference::halfCellShare(half_column, column, space_.columns);
        for (int i = 0; i < space_.textures; ++i) {
          for (int n = 0; n < space_.expressions; ++n) w(i, n) += share * weights_.at(row, column, i, n);
        }
      }
    }
    return w;
  }

  reference::HalfCellFit expected(int half_row, int half_column) const {
    return reference::fitHalfCell(weightsAt(half_row, half_column), deltas(half_row, half_column),
                                  static_cast<double>(kRidge));
  }

  HalfCells halves;
};

std::vector<float> readFloats(const cl::Buffer& buffer, std::size_t count) {
  std::vector<float> values(count);
  test::testDevice().read(buffer, values, "half cells");
  return values;
}

TEST_P(HalfCellsTest, GramMatricesEqualReference) {
  HalfCellProblem problem(GetParam());
  const int n_count = problem.space_.expressions;
  const int groups = problem.halves.rows().groups;
  const auto pairs = static_cast<std::size_t>(n_count * (n_count + 1) / 2);
  const std::vector<float> grams =
      readFloats(problem.halves.grams(), static_cast<std::size_t>(problem.halves.rows().count * groups) * pairs * 16);
  for (int y = 0; y < problem.halves.rows().count; ++y) {
    for (int x = 0; x < 2 * problem.space_.columns; ++x) {
      const Eigen::MatrixXd deltas = problem.deltas(problem.halves.rows().first + y, x);
      const Eigen::MatrixXd expected = deltas * deltas.transpose();
      for (int m = 0; m < n_count; ++m) {
        for (int n = 0; n <= m; ++n) {
          const std::size_t pair =
              static_cast<std::size_t>(y * groups + x / 16) * pairs + static_cast<std::size_t>(m * (m + 1) / 2 + n);
          ASSERT_NEAR(static_cast<double>(grams[pair * 16 + static_cast<std::size_t>(x % 16)]), expected(n, m),
                      test::kFitErrorRelative * (1.0 + std::sqrt(expected(n, n) * expected(m, m))))
              << y << " " << x << ": " << n << " " << m;
        }
      }
    }
  }
}

TEST_P(HalfCellsTest, FitEqualsReference) {
  HalfCellProblem problem(GetParam());
  problem.halves.fit(problem.window_, kRidge);
  const int c = problem.space_.textures;
  const std::size_t sides_begin = roundUp(toSize(c * (c + 1) / 2), 16);
  const std::size_t entries = sides_begin + problem.space_.cellFloats();
  const std::vector<float> halves =
      readFloats(problem.halves.equations(),
                 static_cast<std::size_t>(problem.halves.rows().count * problem.halves.rows().columns()) * entries);
  double error = 0.0;
  double energy = 0.0;
  const WindowRows& rows = problem.window_.rows();
  for (int y = 0; y < problem.halves.rows().count; ++y) {
    const int half_row = problem.halves.rows().first + y;
    for (int x = 0; x < 2 * problem.space_.columns; ++x) {
      const reference::HalfCellFit fit = problem.expected(half_row, x);
      const float* got = halves.data() + static_cast<std::size_t>(y * problem.halves.rows().columns() + x) * entries;
      // What rounding does to the solution grows with the condition of the system.
      const double condition =
          std::max(1.0, problem.weightsAt(half_row, x).squaredNorm() / static_cast<double>(kRidge));
      const double deltas = problem.deltas(half_row, x).squaredNorm();
      const double tolerance = test::kSolveRelative * condition * (1.0 + deltas + fit.block.norm());
      for (int i = 0; i < c; ++i) {
        for (int j = 0; j <= i; ++j) {
          ASSERT_NEAR(static_cast<double>(got[i * (i + 1) / 2 + j]), fit.block(i, j), tolerance) << y << " " << x;
        }
        for (int n = 0; n < problem.space_.expressions; ++n) {
          const std::size_t at = sides_begin + static_cast<std::size_t>(i) * problem.space_.lanes();
          ASSERT_NEAR(static_cast<double>(got[at + static_cast<std::size_t>(n)]), fit.sides(i, n), tolerance);
        }
      }
      if (half_row < 2 * rows.free_begin || half_row >= 2 * rows.free_end) continue;
      error += fit.error;
      energy += deltas;
    }
  }
  EXPECT_NEAR(problem.halves.error(), error, 10.0 * test::kFitErrorRelative * energy);
}

TEST_P(HalfCellsTest, GatheredEquationsEqualReference) {
  HalfCellProblem problem(GetParam());
  problem.halves.fit(problem.window_, kRidge);
  problem.system_.gather(problem.halves, problem.window_);
  const WeightSpace& space = problem.space_;
  const WindowRows& rows = problem.window_.rows();
  const int c = space.textures;
  const std::size_t entries = space.systemEntries();
  const std::vector<float> system =
      readFloats(problem.system_.equations(), static_cast<std::size_t>(rows.count() * space.columns) * entries);
  for (int row = rows.free_begin; row < rows.free_end; ++row) {
    for (int column = 0; column < space.columns; ++column) {
      const float* got =
          system.data() + static_cast<std::size_t>((row - rows.begin) * space.columns + column) * entries;
      Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(c, space.expressions);
      Eigen::MatrixXd blocks[4];
      for (Eigen::MatrixXd& block : blocks) block = Eigen::MatrixXd::Zero(c, c);
      double scale = 1.0;
      for (int y = std::max(0, 2 * row - 1); y < std::min(2 * space.rows, 2 * row + 3); ++y) {
        for (int x = std::max(0, 2 * column - 1); x < std::min(2 * space.columns, 2 * column + 3); ++x) {
          const reference::HalfCellFit fit = problem.expected(y, x);
          const auto along_y = [&](int r) { return reference::halfCellShare(y, r, space.rows); };
          const auto along_x = [&](int q) { return reference::halfCellShare(x, q, space.columns); };
          const double share = along_y(row) * along_x(column);
          sides += share * fit.sides;
          for (int k = 0; k < 4; ++k) {
            const int r = row + k / 2;
            const int q = column + k % 2;
            if (r < space.rows && q < space.columns) blocks[k] += share * along_y(r) * along_x(q) * fit.block;
          }
          scale += fit.block.norm() + fit.sides.norm() + problem.deltas(y, x).squaredNorm();
        }
      }
      const double tolerance = 1e-4 * scale;
      for (int i = 0; i < c; ++i) {
        for (int n = 0; n < space.expressions; ++n) {
          const std::size_t at = entries - space.cellFloats() + static_cast<std::size_t>(i) * space.lanes();
          ASSERT_NEAR(static_cast<double>(got[at + static_cast<std::size_t>(n)]), sides(i, n), tolerance)
              << row << " " << column;
        }
        for (int j = 0; j <= i; ++j) {
          for (int k = 0; k < 4; ++k) {
            ASSERT_NEAR(static_cast<double>(got[k * c * (c + 1) / 2 + i * (i + 1) / 2 + j]), blocks[k](i, j), tolerance)
                << row << " " << column << " block " << k;
          }
        }
      }
    }
  }
}

TEST_P(HalfCellsTest, BlocksStayPositiveWhereTwoTexturesShareTheirWeights) {
  constexpr float kSmallRidge = 1e-4f;  // magnifies what rounding leaves along their difference
  HalfCellProblem problem(GetParam());
  const int c = problem.space_.textures;
  if (c < 2) GTEST_SKIP() << "one texture";
  std::vector<float> weights = problem.window_.weights();
  const std::size_t lanes = problem.space_.lanes();
  for (std::size_t cell = 0; cell < weights.size(); cell += problem.space_.cellFloats()) {
    for (std::size_t n = 0; n < lanes; ++n) weights[cell + lanes + n] = weights[cell + n];
  }
  problem.window_.set(problem.window_.rows(), weights, weights);
  problem.halves.fit(problem.window_, kSmallRidge);
  const std::size_t entries =
      roundUp(toSize(c * (c + 1) / 2), 16) + problem.space_.cellFloats();
  const std::vector<float> halves =
      readFloats(problem.halves.equations(),
                 static_cast<std::size_t>(problem.halves.rows().count * problem.halves.rows().columns()) * entries);
  for (std::size_t half = 0; half < halves.size(); half += entries) {
    Eigen::MatrixXd block(c, c);
    for (int i = 0; i < c; ++i) {
      for (int j = 0; j <= i; ++j) {
        block(i, j) = block(j, i) = static_cast<double>(halves[half + static_cast<std::size_t>(i * (i + 1) / 2 + j)]);
      }
    }
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(block).eigenvalues();
    ASSERT_GE(values.minCoeff(), -test::kSolveRelative * values.maxCoeff()) << half / entries;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, HalfCellsTest, testing::ValuesIn(kGridCases));
INSTANTIATE_TEST_SUITE_P(OneTexture, HalfCellsTest,
                         testing::Values(GridCase{{7, 5, 3, 2, SampleType::kUint8}, 8, 1, 0, 0}));

}  // namespace
}  // namespace facezip::compress
