// weight_relax.cl - one colour of a block Gauss-Seidel sweep over the weight grid
//   W_n(q) = argmin of   data term (weight_system.cl) + smoothness * sum over q's 4 neighbours |W_n(q) - W_n(q')|^2
//                        + trust * |W_n(q) - start_n(q)|^2      with all other cells as they are
// Cells couple to their 8 neighbours only, so the cells of one of 4 colours (parity of row and column) do not touch each
// other: each step is exact and lowers the objective, whatever the order of the work-items.
//
// NDRange  global {EXPRESSION_LANES / LANES, columns of the colour, rows of the colour}, local {a divisor of it, 1, 1}
// Buffers  system   in      [row][column][ENTRIES] float   cell rows from first_cell_row on
//          start    in      [row][column][C][lanes] float
//          weights  in out  the same
// Defines  TEXTURES, EXPRESSION_LANES  grid_weights.h
//          LANES                       expressions of a work-item: 16 on CPUs (16), 1 on GPUs

#define MATRIX_T float  // a cell has one matrix for all expressions
#include "cholesky.h"

#define PAIR(i, j) ((i) > (j) ? LOWER(i, j) : LOWER(j, i))
#define PLANE (EXPRESSION_LANES / LANES)

// residual -= (block + smoothness on the diagonal, which pulls towards the neighbour) * W(neighbour)
static void add_neighbour(global const float* restrict block, const float smoothness, global const floats* restrict cell,
                          floats* residual) {
#pragma unroll
  for (int j = 0; j < TEXTURES; ++j) {
    const floats w = cell[j * PLANE];
    residual[j] += smoothness * w;
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) residual[i] -= block[PAIR(i, j)] * w;
  }
}

// x = (block + diagonal)^-1 x.
static void solve_block(global const float* restrict block, const float diagonal, floats x[TEXTURES]) {
  float l[PAIRS];
#pragma unroll
  for (int p = 0; p < PAIRS; ++p) l[p] = block[p];
  factor(l, diagonal);
  substitute_forward(l, x);
#pragma unroll
  for (int i = TEXTURES - 1; i >= 0; --i) x[i] = substitute_back(l, x, i);
}

kernel void weight_relax(global const float* restrict system, global const floats* restrict start,
                         global floats* restrict weights, const int first_column, const int first_free_row,
                         const int cell_columns, const int held_rows, const float smoothness, const float trust) {
  const int lane = (int)get_global_id(0);
  const int column = first_column + 2 * (int)get_global_id(1);
  const int row = first_free_row + 2 * (int)get_global_id(2);  // counted from the first row that is held
  const long cell = (long)row * cell_columns + column;
  global const float* entries = system + cell * ENTRIES;
  global floats* w = weights + cell * (TEXTURES * PLANE) + lane;
  const long line = (long)cell_columns;

  floats residual[TEXTURES];
#pragma unroll
  for (int i = 0; i < TEXTURES; ++i) {
    residual[i] = ((global const floats*)(entries + BLOCKS_END))[i * PLANE + lane] +
                  trust * start[(cell * TEXTURES + i) * PLANE + lane];
  }
  const bool left = column > 0;
  const bool right = column + 1 < cell_columns;
  const bool above = row > 0;
  const bool below = row + 1 < held_rows;
#define NEIGHBOUR(exists, owner, block, pull, offset) \
  if (exists) add_neighbour(entries + (owner) * ENTRIES + (block) * PAIRS, pull, w + (offset) * (TEXTURES * PLANE), residual)
  NEIGHBOUR(left, -1, 1, smoothness, -1);
  NEIGHBOUR(right, 0, 1, smoothness, 1);
  NEIGHBOUR(above, -line, 2, smoothness, -line);
  NEIGHBOUR(below, 0, 2, smoothness, line);
  NEIGHBOUR(above && left, -line - 1, 3, 0.0f, -line - 1);
  NEIGHBOUR(above && right, -line, 3, 0.0f, -line + 1);
  NEIGHBOUR(below && left, -1, 3, 0.0f, line - 1);
  NEIGHBOUR(below && right, 0, 3, 0.0f, line + 1);
  const float neighbours = (float)(left + right + above + below);
  solve_block(entries, smoothness * neighbours + trust, residual);
#pragma unroll
  for (int i = 0; i < TEXTURES; ++i) w[i * PLANE] = residual[i];
}
