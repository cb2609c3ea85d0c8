// half_cell_fit.hpp - problem of the step `half_cell_fit`.
#pragma once

#include "problems/half_cell_gram.hpp"
#include "reference/half_cell_fit.hpp"

namespace facezip::test {

/// Must move: Gram matrices and weights in, equations out. Operations, for each half cell: the weights' products with
/// each other and with the Gram matrix, that with the weights again, and two triangles for each expression.
struct HalfCellFitProblem : HalfCellGramProblem {
  HalfCellFitProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free)
      : HalfCellGramProblem(device, grid_sizes, std::move(tile_masks), free) {
    HalfCellGramProblem::run();
  }

  void run() {
    halves.fit(window, ridge);
    context.finish();
  }

  /// Equations of half cells: [half row][half column][entry], half rows from halves.rows().first on
  Layout<3> halfLayout() const {
    return Layout(halves.rows().count, halves.rows().columns(), compress::halfCellEntries(space));
  }
  int sideEntry(int i, int n) const {
    return FACEZIP_HALF_CELL_MATRIX(space.textures) + i * static_cast<int>(space.lanes()) + n;
  }
  std::vector<float> result() const {
    return context.download<float>(halves.equations(), halfLayout().size(), "equations of the half cells");
  }
  reference::HalfCellFit expected(int half_row, int half_column) const {
    return reference::fitHalfCell(weightsAt(half_row, half_column), deltas(half_row, half_column),
                                  static_cast<double>(ridge));
  }
  /// Weights at the centre of a half cell, C x N.
  Eigen::MatrixXd weightsAt(int half_row, int half_column) const {
    Eigen::MatrixXd w = Eigen::MatrixXd::Zero(space.textures, space.expressions);
    for (int row = std::max(0, half_row / 2 - 1); row < std::min(space.rows, half_row / 2 + 2); ++row) {
      for (int column = std::max(0, half_column / 2 - 1); column < std::min(space.columns, half_column / 2 + 2);
           ++column) {
        const double share = reference::halfCellShare(half_row, row, space.rows) *
                             reference::halfCellShare(half_column, column, space.columns);
        for (int i = 0; i < space.textures; ++i) {
          for (int n = 0; n < space.expressions; ++n) w(i, n) += share * weights.at(row, column, i, n);
        }
      }
    }
    return w;
  }

  double halfBytes() const { return halfCells() * (static_cast<double>(space.cellFloats()) + pairs()) * sizeof(float); }
  double bytes() const { return gramBytes() + weightBytes() + halfBytes(); }
  double flops() const {
    const double c = space.textures;
    const double n = space.expressions;
    return 2.0 * halfCells() * n * (2.0 * pairs() + c * n + c * c);
  }

  float ridge = 0.01f;
};

}  // namespace facezip::test
