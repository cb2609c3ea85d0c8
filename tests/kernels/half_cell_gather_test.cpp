#include "problems/half_cell_gather.hpp"

#include <gtest/gtest.h>

#include "grid_sizes.hpp"
#include "problems/weight_system.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

class HalfCellGather : public HalfCellTest {};

TEST_P(HalfCellGather, EqualsReference) {
  auto problem = scattered<HalfCellGatherProblem>(GetParam());
  problem.run();
  const std::vector<float> system = problem.result();
  const CellEntries entries{problem.space};
  const compress::WindowRows& rows = problem.window.rows();
  for (int row = rows.free_begin; row < rows.free_end; ++row) {
    for (int column = 0; column < problem.space.columns; ++column) {
      const auto at = [&](int entry) {
        return static_cast<double>(system[problem.systemLayout()(row - rows.begin, column, entry)]);
      };
      const reference::CellEquations expected = problem.expectedCell(row, column);
      double scale = 1.0;
      for (int y = std::max(0, 2 * row - 1); y < std::min(2 * problem.space.rows, 2 * row + 3); ++y) {
        for (int x = std::max(0, 2 * column - 1); x < std::min(2 * problem.space.columns, 2 * column + 3); ++x) {
          const reference::HalfCellFit fit = problem.expected(y, x);
          scale += fit.block.norm() + fit.sides.norm() + problem.deltas(y, x).squaredNorm();
        }
      }
      for (int i = 0; i < problem.space.textures; ++i) {
        for (int n = 0; n < problem.space.expressions; ++n) {
          ASSERT_NEAR(at(entries.side(i, n)), expected.sides(i, n), kGatheredHalfCells * scale) << row << " " << column;
        }
        for (int j = 0; j <= i; ++j) {
          for (int k = 0; k < 4; ++k) {
            ASSERT_NEAR(at(entries.block(k, i, j)), expected.blocks[k](i, j), kGatheredHalfCells * scale)
                << row << " " << column << " block " << k;
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, HalfCellGather, testing::ValuesIn(kGridSizes));
INSTANTIATE_TEST_SUITE_P(OneTexture, HalfCellGather, testing::Values(kOneTexture));

}  // namespace
}  // namespace facezip::test
