// Reference for kernels/cl/weight_relax.cl: one cell at the minimum of the objective, and the objective itself, in
// double.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "reference/weight_system.hpp"

namespace facezip::reference {

/// What the two half-steps share: data term + ridge |D|^2 (both times the texel weight) + smoothness over the grid's
/// edges + trust in `start`.
inline double objective(const GridWeights& grid, const GridWeights& start, const std::vector<FitTexel>& texels,
                        double ridge, double smoothness, double trust) {
  double sum = 0.0;
  for (const FitTexel& p : texels) {
    const Eigen::MatrixXd w = grid.texel(p.x, p.y);
    sum += p.weight * ((p.delta - w.transpose() * p.difference).squaredNorm() + ridge * p.difference.squaredNorm());
  }
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      for (int i = 0; i < grid.textures; ++i) {
        for (int n = 0; n < grid.expressions; ++n) {
          const double value = grid.at(row, column, i, n);
          sum += trust * std::pow(value - start.at(row, column, i, n), 2);
          if (column + 1 < grid.columns) sum += smoothness * std::pow(value - grid.at(row, column + 1, i, n), 2);
          if (row + 1 < grid.rows) sum += smoothness * std::pow(value - grid.at(row + 1, column, i, n), 2);
        }
      }
    }
  }
  return sum;
}

/// Moves one cell to the minimum of the objective with all others as they are.
inline void relaxCell(GridWeights& grid, const GridWeights& start, const std::vector<FitTexel>& texels, int row,
                      int column, double smoothness, double trust) {
  const int c = grid.textures;
  Eigen::MatrixXd matrix = systemBlock(grid, texels, row, column, row, column);
  Eigen::MatrixXd side = systemSides(grid, texels, row, column);
  matrix.diagonal().array() += trust;
  const auto values = [&](const GridWeights& from, int r, int q) {
    Eigen::MatrixXd w(c, grid.expressions);
    for (int i = 0; i < c; ++i) {
      for (int n = 0; n < grid.expressions; ++n) w(i, n) = from.at(r, q, i, n);
    }
    return w;
  };
  side += trust * values(start, row, column);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int r = row + dy;
      const int q = column + dx;
      if ((dx == 0 && dy == 0) || r < 0 || q < 0 || r >= grid.rows || q >= grid.columns) continue;
      side -= systemBlock(grid, texels, row, column, r, q) * values(grid, r, q);
      if (dx == 0 || dy == 0) {
        side += smoothness * values(grid, r, q);
        matrix.diagonal().array() += smoothness;
      }
    }
  }
  const Eigen::MatrixXd solution = matrix.ldlt().solve(side);
  for (int i = 0; i < c; ++i) {
    for (int n = 0; n < grid.expressions; ++n) grid.at(row, column, i, n) = solution(i, n);
  }
}

}  // namespace facezip::reference
