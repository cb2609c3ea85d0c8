// Reference for kernels/cl/weight_system_gather.cl: the numbers of a cell added up over the tiles that hold some, in
// double.
#pragma once

#include <cstddef>
#include <vector>

namespace facezip::reference {

/// Numbers of the cells of a patch of the grid, as one tile has summed them.
struct TileSums {
  int first_row = 0;            ///< of the patch
  int first_column = 0;         ///< of the patch
  int side = 0;                 ///< cells along either axis of the patch
  std::vector<double> numbers;  ///< [row][column][entries]
};

/// Entry `entry` of cell (row, column), `entries` of them in each.
inline double gatherEntry(const std::vector<TileSums>& tiles, int row, int column, int entry, int entries) {
  double sum = 0.0;
  for (const TileSums& tile : tiles) {
    const int r = row - tile.first_row;
    const int q = column - tile.first_column;
    if (r < 0 || q < 0 || r >= tile.side || q >= tile.side) continue;
    sum += tile.numbers[static_cast<std::size_t>((r * tile.side + q) * entries + entry)];
  }
  return sum;
}

}  // namespace facezip::reference
