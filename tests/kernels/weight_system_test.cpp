#include "problems/weight_system.hpp"

#include <gtest/gtest.h>

#include "grid_sizes.hpp"
#include "tolerances.hpp"

namespace facezip::test {
namespace {

class WeightSystem : public GridTest {};

TEST_P(WeightSystem, SumsOfEveryTileEqualReference) {
  for (const device::KernelVariant variant : variants()) {
    auto problem = scattered<WeightSystemProblem>(GetParam(), variant);
    problem.run();
    const std::vector<float> textures = problem.DifferenceFitProblem::result();
    const std::vector<float> sums = problem.result();
    const CellEntries entries{problem.space};
    for (std::size_t tile = 0; tile < problem.tileCount(); ++tile) {
      std::vector<reference::FitTexel> texels;
      problem.appendTexels(textures, tile, texels);
      for (int r = 0; r < problem.patchSide(); ++r) {
        for (int q = 0; q < problem.patchSide(); ++q) {
          const int row = problem.patchRow(tile) + r;
          const int column = problem.patchColumn(tile) + q;
          if (row >= problem.space.rows || column >= problem.space.columns) continue;
          const std::vector<double> expected = problem.cellEntries(texels, row, column);
          double scale = 1.0;
          for (int i = 0; i < problem.space.textures; ++i) scale += expected[toSize(entries.block(0, i, i))];
          for (int i = entries.side(0, 0); i < entries.count(); ++i) scale += std::abs(expected[toSize(i)]);
          for (int e = 0; e < entries.count(); ++e) {
            ASSERT_NEAR(static_cast<double>(sums[problem.sumLayout()(tile, r, q, e)]), expected[toSize(e)],
                        kSystemRelative * scale)
                << "tile " << tile << ", cell " << row << " " << column << ", entry " << e;
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, WeightSystem, testing::ValuesIn(kGridSizes));
INSTANTIATE_TEST_SUITE_P(Odd, WeightSystem, testing::ValuesIn(kOddSizes));

}  // namespace
}  // namespace facezip::test
