// Reference for kernels/cl/half_cell_gather.cl: the equations of one cell from those of its half cells, in double.
#pragma once

#include <Eigen/Dense>
#include <algorithm>

#include "reference/half_cell_fit.hpp"
#include "reference/weight_grid.hpp"

namespace facezip::reference {

/// Of one cell.
struct CellEquations {
  Eigen::MatrixXd blocks[4];  ///< to itself, the cell on the right, below, and below on the right; C x C
  Eigen::MatrixXd sides;      ///< C x N
};

/// fit_of(y, x)  HalfCellFit of a half cell of the grid of rows x columns cells
template <typename FitOf>
CellEquations gatherHalfCells(int row, int column, int rows, int columns, int textures, int expressions,
                              const FitOf& fit_of) {
  CellEquations cell;
  cell.sides = Eigen::MatrixXd::Zero(textures, expressions);
  for (Eigen::MatrixXd& block : cell.blocks) block = Eigen::MatrixXd::Zero(textures, textures);
  for (int y = std::max(0, 2 * row - 1); y < std::min(2 * rows, 2 * row + 3); ++y) {
    for (int x = std::max(0, 2 * column - 1); x < std::min(2 * columns, 2 * column + 3); ++x) {
      const HalfCellFit fit = fit_of(y, x);
      const double share = halfCellShare(y, row, rows) * halfCellShare(x, column, columns);
      cell.sides += share * fit.sides;
      for (int k = 0; k < 4; ++k) {
        const int r = row + k / 2;
        const int q = column + k % 2;
        if (r >= rows || q >= columns) continue;
        cell.blocks[k] += share * halfCellShare(y, r, rows) * halfCellShare(x, q, columns) * fit.block;
      }
    }
  }
  return cell;
}

}  // namespace facezip::reference
