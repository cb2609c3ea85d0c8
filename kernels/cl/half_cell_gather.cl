// half_cell_gather.cl - the equations of every cell of the weight grid (weight_system.cl) from those of its half cells
// Half cell 2 q of a row weighs 3/4 in cell q and 1/4 in cell q - 1, half cell 2 q + 1 in q and q + 1; beyond the edge the
// outer cell repeats.
//
// NDRange  global {1 + C * lanes / 16, columns, rows}, local {a divisor of it, 1, 1}: the blocks of a cell,
//          then 16 right-hand sides each
// Buffers  halves  in   as half_cell_fit.cl writes it, half rows from first_half_row on
//          system  out  [row][column][ENTRIES] float   cell rows from first_cell_row on
// Defines  TEXTURES, EXPRESSION_LANES  grid_weights.h
// Sums     fixed order: half cells by row, then column

#include "common.h"
#include "grid_weights.h"

// What half cell h weighs in cell q of `cells`.
inline float share(const int h, const int q, const int cells) {
  const int own = h / 2;
  const int next = clamp(own + (h % 2 ? 1 : -1), 0, cells - 1);
  return (own == q ? 0.75f : 0.0f) + (next == q ? 0.25f : 0.0f);
}

static void add_sides(global const float16* restrict half_cell, const float weight, const int vector, float16* sum) {
  *sum = FMA((float16)(weight), half_cell[SIDES_BEGIN / 16 + vector], *sum);
}

kernel void half_cell_gather(global const float* restrict halves, global float* restrict system,
                             const int first_half_row, const int held_half_rows, const int first_cell_row,
                             const int cell_rows, const int half_columns) {
  const int part = (int)get_global_id(0);
  const int column = (int)get_global_id(1);
  const int columns = (int)get_global_size(1);
  const int row = first_cell_row + (int)get_global_id(2);
  global float* out = system + ((ulong)get_global_id(2) * columns + column) * ENTRIES;
  float blocks[BLOCKS_END];
  float16 sides = 0.0f;
  if (part == 0) {
    for (int k = 0; k < BLOCKS_END; ++k) blocks[k] = 0.0f;
  }
  for (int y = max(2 * row - 1, first_half_row); y < min(2 * row + 3, first_half_row + held_half_rows); ++y) {
    const float share_y = share(y, row, cell_rows);
    const float below_y = row + 1 < cell_rows ? share_y * share(y, row + 1, cell_rows) : 0.0f;
    const float self_y = share_y * share_y;
    for (int x = max(2 * column - 1, 0); x < min(2 * column + 3, 2 * columns); ++x) {
      const float share_x = share(x, column, columns);
      global const float* half_cell = halves + ((ulong)(y - first_half_row) * half_columns + x) * HALF_ENTRIES;
      if (part > 0) {
        add_sides((global const float16*)half_cell, share_x * share_y, part - 1, &sides);
        continue;
      }
      const float right_x = column + 1 < columns ? share_x * share(x, column + 1, columns) : 0.0f;
      const float self_x = share_x * share_x;
      for (int p = 0; p < PAIRS; ++p) {
        blocks[p] += self_x * self_y * half_cell[p];
        blocks[PAIRS + p] += right_x * self_y * half_cell[p];
        blocks[2 * PAIRS + p] += self_x * below_y * half_cell[p];
        blocks[3 * PAIRS + p] += right_x * below_y * half_cell[p];
      }
    }
  }
  if (part > 0) {
    ((global float16*)(out + BLOCKS_END))[part - 1] = sides;
  } else {
    for (int k = 0; k < BLOCKS_END; ++k) out[k] = blocks[k];
  }
}
