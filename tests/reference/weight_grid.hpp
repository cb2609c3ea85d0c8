// Weights on a grid, and what they are at a texel: bilinear between the centres of the cells, the edge repeated, in
// double.
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

/// Weight of cell q at the centre of half cell h, along one axis: the bilinear hat with the edge repeated.
inline double halfCellShare(int h, int q, int cells) {
  const double position = std::clamp((h + 0.5) / 2.0 - 0.5, 0.0, cells - 1.0);
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

}  // namespace facezip::reference
