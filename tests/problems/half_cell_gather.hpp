// half_cell_gather.hpp - problem of the step `half_cell_gather`.
#pragma once

#include "problems/half_cell_fit.hpp"
#include "reference/half_cell_gather.hpp"
#include "refine/weight_system.hpp"

namespace facezip::test {

/// Must move: the equations of the half cells in, those of the cells out.
struct HalfCellGatherProblem : HalfCellFitProblem {
  HalfCellGatherProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free)
      : HalfCellFitProblem(device, grid_sizes, std::move(tile_masks), free), system(device, space) {
    HalfCellFitProblem::run();
  }

  void run() {
    system.gather(halves, window);
    context.finish();
  }

  /// [held row][column][entry]
  Layout<3> systemLayout() const { return Layout(window.rows().count(), space.columns, space.systemEntries()); }
  std::vector<float> result() const {
    return context.download<float>(system.equations(), systemLayout().size(), "equations of the cells");
  }
  reference::CellEquations expectedCell(int row, int column) const {
    return reference::gatherHalfCells(
        row, column, space.rows, space.columns, space.textures, space.expressions,
        [this](int half_row, int half_column) { return expected(half_row, half_column); });
  }

  double bytes() const { return halfBytes() + systemBytes(); }
  double flops() const { return 0.0; }

  compress::WeightSystem system;
};

}  // namespace facezip::test
