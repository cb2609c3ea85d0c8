// weight_system_gather.cl - adds up, for every cell of the weight grid, what the tiles of a band hold of its equations
//   system[q] = keep * system[q] + metric_weight * sum over tiles of partial[tile][q]
//
// NDRange  global {ENTRIES / 16, columns, rows}, local {a divisor of it, 1, 1}: one work-item per 16 numbers of a cell
// Buffers  tile_at  in   [tile rows][tile columns] int   index of a tile of the band, -1 where there is none
//          partial  in   as weight_system.cl writes it
//          system   out  [row][column][ENTRIES] float    cell rows from first_cell_row on
// Defines  ENTRIES       numbers of a cell, a multiple of 16 (96: four textures, 16 expressions or fewer)
//          WEIGHT_SCALE  weight_grid.h
// Sums     fixed order: tiles by row, then column

#include "tiles.h"
#include "weight_grid.h"

#ifndef ENTRIES
#define ENTRIES 96
#endif

kernel void weight_system_gather(global const int* restrict tile_at, global const float16* restrict partial,
                                 global float16* restrict system, const int tile_columns, const int tile_rows,
                                 const int first_row, const int first_cell_row, const int cell_columns,
                                 const int cell_rows, const float metric_weight, const int keep) {
  const int entry = (int)get_global_id(0);
  const int column = (int)get_global_id(1);
  const int row = first_cell_row + (int)get_global_id(2);
  // Texels of the cell reach from its centre as far as the neighbours' centres; a tile more on either side is checked.
  const int x_begin = max((column - 1) * WEIGHT_SCALE / TILE_SIDE - 1, 0);
  const int x_end = min((column + 2) * WEIGHT_SCALE / TILE_SIDE + 1, tile_columns);
  const int y_begin = max(((row - 1) * WEIGHT_SCALE - first_row) / TILE_SIDE - 1, 0);
  const int y_end = min(((row + 2) * WEIGHT_SCALE - first_row) / TILE_SIDE + 1, tile_rows);
  float16 sum = 0.0f;
  for (int y = y_begin; y < y_end; ++y) {
    const int r = row - (int)cell_position(first_row + y * TILE_SIDE, cell_rows);
    if (r < 0 || r >= CELLS_OF_16) continue;
    for (int x = x_begin; x < x_end; ++x) {
      const int c = column - (int)cell_position(x * TILE_SIDE, cell_columns);
      const int tile = tile_at[y * tile_columns + x];
      if (c < 0 || c >= CELLS_OF_16 || tile < 0) continue;
      sum += partial[(((ulong)tile * CELLS_OF_16 + r) * CELLS_OF_16 + c) * (ENTRIES / 16) + entry];
    }
  }
  const ulong at = ((ulong)get_global_id(2) * cell_columns + column) * (ENTRIES / 16) + entry;
  const float16 kept = keep ? system[at] : (float16)(0.0f);
  system[at] = FMA((float16)(metric_weight), sum, kept);
}
