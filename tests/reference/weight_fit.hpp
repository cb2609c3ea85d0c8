// References for kernels/cl/difference_fit.cl, weight_system*.cl and weight_relax.cl: both halves of the alternating
// least squares, cell by cell and texel by texel in double.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace facezip::reference {

/// Weight of cell `q` of `cells` along one axis at texel `x`: the bilinear hat with the edge repeated.
inline double hat(int x, int q, int cells, int scale) {
  const double position = std::clamp((x + 0.5) / scale - 0.5, 0.0, cells - 1.0);
  return std::max(0.0, 1.0 - std::abs(position - q));
}

/// Weight maps of N expressions and C textures on a grid.
struct GridWeights {
  int columns = 0;
  int rows = 0;
  int scale = 0;  ///< texels per cell
  int textures = 0;
  int expressions = 0;
  std::vector<double> values;  ///< [row][column][C][N]

  double& at(int row, int column, int i, int n) {
    return values[static_cast<std::size_t>(((row * columns + column) * textures + i) * expressions + n)];
  }
  double at(int row, int column, int i, int n) const { return const_cast<GridWeights*>(this)->at(row, column, i, n); }

  /// w_n at texel (x, y), [C][N].
  Eigen::MatrixXd texel(int x, int y) const {
    Eigen::MatrixXd w = Eigen::MatrixXd::Zero(textures, expressions);
    for (int row = 0; row < rows; ++row) {
      const double along_y = hat(y, row, rows, scale);
      if (along_y == 0.0) continue;
      for (int column = 0; column < columns; ++column) {
        const double weight = along_y * hat(x, column, columns, scale);
        if (weight == 0.0) continue;
        for (int i = 0; i < textures; ++i) {
          for (int n = 0; n < expressions; ++n) w(i, n) += weight * at(row, column, i, n);
        }
      }
    }
    return w;
  }
};

/// D (C x channels) that minimises |delta - w^T D|^2 + ridge |D|^2; w is C x N, delta N x channels.
inline Eigen::MatrixXd fitDifference(const Eigen::MatrixXd& w, const Eigen::MatrixXd& delta, double ridge) {
  const Eigen::MatrixXd a = w * w.transpose() + ridge * Eigen::MatrixXd::Identity(w.rows(), w.rows());
  return a.ldlt().solve(w * delta);
}

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
