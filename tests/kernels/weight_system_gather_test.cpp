#include "problems/weight_system_gather.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "grid_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

class WeightSystemGather : public GridTest {};

TEST_P(WeightSystemGather, AddsUpTheTilesOfEveryCell) {
  auto problem = scattered<WeightSystemGatherProblem>(GetParam());
  problem.run();
  // A second map on the same grid.
  problem.system.gather(problem.band(), problem.tile_at, problem.window, 0.5);
  const std::vector<float> system = problem.result();
  const std::vector<reference::TileSums> tiles = problem.tileSums();
  const int entries = CellEntries{problem.space}.count();
  const compress::WindowRows& rows = problem.window.rows();
  for (int row = rows.begin; row < rows.end; ++row) {
    for (int column = 0; column < problem.space.columns; ++column) {
      for (int e = 0; e < entries; ++e) {
        const double expected = 1.5 * reference::gatherEntry(tiles, row, column, e, entries);
        ASSERT_NEAR(static_cast<double>(system[problem.systemLayout()(row - rows.begin, column, e)]), expected,
                    kSystemRelative * (1.0 + std::abs(expected)))
            << row << " " << column << ", entry " << e;
      }
    }
  }
}

/// Of tiles that the kernels have summed: cells get all that the texels of the band hold of them.
TEST_P(WeightSystemGather, GivesTheEquationsOfAllTexels) {
  auto problem = scattered<WeightSystemGatherProblem>(GetParam());
  problem.run();
  const std::vector<float> system = problem.result();
  const std::vector<reference::FitTexel> texels = problem.fitTexels(problem.DifferenceFitProblem::result());
  const CellEntries entries{problem.space};
  const compress::WindowRows& rows = problem.window.rows();
  for (int row = rows.begin; row < rows.end; ++row) {
    for (int column = 0; column < problem.space.columns; ++column) {
      const std::vector<double> expected = problem.cellEntries(texels, row, column);
      double scale = 1.0;
      for (int i = 0; i < problem.space.textures; ++i) scale += expected[toSize(entries.block(0, i, i))];
      for (int i = entries.side(0, 0); i < entries.count(); ++i) scale += std::abs(expected[toSize(i)]);
      for (int e = 0; e < entries.count(); ++e) {
        ASSERT_NEAR(static_cast<double>(system[problem.systemLayout()(row - rows.begin, column, e)]),
                    expected[toSize(e)], kSystemRelative * scale)
            << row << " " << column << ", entry " << e;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, WeightSystemGather, testing::ValuesIn(kGridSizes));
INSTANTIATE_TEST_SUITE_P(Odd, WeightSystemGather, testing::ValuesIn(kOddSizes));

}  // namespace
}  // namespace facezip::test
