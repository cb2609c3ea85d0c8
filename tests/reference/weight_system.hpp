// Reference for kernels/cl/weight_system*.cl: normal equations of the grid weights, cell by cell and texel by texel in
// double.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "reference/weight_grid.hpp"

namespace facezip::reference {

/// A texel that takes part in the system of the weights.
struct FitTexel {
  int x = 0;
  int y = 0;
  double weight = 0.0;
  Eigen::MatrixXd difference;  ///< D, C x channels
  Eigen::MatrixXd delta;       ///< N x channels
};

/// Sum over texels of t h_q h_q' D D^T, C x C.
inline Eigen::MatrixXd systemBlock(const GridWeights& grid, const std::vector<FitTexel>& texels, int row, int column,
                                   int other_row, int other_column) {
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(grid.textures, grid.textures);
  for (const FitTexel& p : texels) {
    const double h = hat(p.y, row, grid.rows, grid.scale) * hat(p.x, column, grid.columns, grid.scale) *
                     hat(p.y, other_row, grid.rows, grid.scale) * hat(p.x, other_column, grid.columns, grid.scale);
    if (h != 0.0) block += p.weight * h * p.difference * p.difference.transpose();
  }
  return block;
}

/// Sum over texels of t h_q D Delta_n, C x N.
inline Eigen::MatrixXd systemSides(const GridWeights& grid, const std::vector<FitTexel>& texels, int row, int column) {
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(grid.textures, grid.expressions);
  for (const FitTexel& p : texels) {
    const double h = hat(p.y, row, grid.rows, grid.scale) * hat(p.x, column, grid.columns, grid.scale);
    if (h != 0.0) sides += p.weight * h * p.difference * p.delta.transpose();
  }
  return sides;
}

}  // namespace facezip::reference
