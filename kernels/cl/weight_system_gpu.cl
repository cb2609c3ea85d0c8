// weight_system_gpu.cl - what weight_system.cl computes, for GPUs: one work-item per number instead of one per tile
//
// NDRange  global {ENTRIES, CELLS_OF_16 * CELLS_OF_16, tiles}, local {16, 1, 1}
// Buffers, defines  as in weight_system.cl
// Sums     fixed order: rows, then columns of the tile

#include "grid_weights.h"
#include "tiles.h"
#include "weight_grid.h"

#define CELLS CELLS_OF_16

inline float hat(const float position, const int cell) { return fmax(1.0f - fabs(position - (float)cell), 0.0f); }

kernel void weight_system_gpu(global const int2* restrict tiles, global const float* restrict texel_weights,
                              global const DIFF_T* restrict differences, global const float* restrict textures,
                              global float* restrict partial, const int first_row, const int cell_columns,
                              const int cell_rows) {
  const int entry = (int)get_global_id(0);
  const int cell = (int)get_global_id(1);
  const ulong tile = get_global_id(2);
  const int x0 = tiles[tile].x * TILE_SIDE;
  const int y0 = first_row + tiles[tile].y * TILE_SIDE;
  const int column = (int)cell_position(x0, cell_columns) + cell % CELLS;
  const int row = (int)cell_position(y0, cell_rows) + cell / CELLS;

  const bool is_side = entry >= BLOCKS_END;
  const int block = is_side ? 0 : entry / PAIRS;
  int i = (entry - BLOCKS_END) / EXPRESSION_LANES;
  int j = 0;
  const int n = (entry - BLOCKS_END) % EXPRESSION_LANES;
  if (!is_side) {
    const int pair = entry % PAIRS;
    i = 0;
    while ((i + 1) * (i + 2) / 2 <= pair) ++i;
    j = pair - i * (i + 1) / 2;
  }
  float sum = 0.0f;
  if (is_side ? n < EXPRESSIONS : block < 4) {
    // The other factor: another texture at this or a neighbouring cell, or the difference of an expression.
    const int right = is_side ? 0 : block & 1;
    const int down = is_side ? 0 : block >> 1;
    global const float* d = textures + (tile * TEXTURES + i) * (ulong)(CHANNELS * TILE_TEXELS);
    global const float* e = textures + (tile * TEXTURES + j) * (ulong)(CHANNELS * TILE_TEXELS);
    global const DIFF_T* delta = differences + (tile * EXPRESSIONS + (is_side ? n : 0)) * (ulong)(CHANNELS * TILE_TEXELS);
    for (int y = 0; y < TILE_SIDE; ++y) {
      const float at_y = cell_position(y0 + y, cell_rows);
      const float along_y = hat(at_y, row) * (is_side ? 1.0f : hat(at_y, row + down));
      if (along_y == 0.0f) continue;
      for (int x = 0; x < TILE_SIDE; ++x) {
        const float at_x = cell_position(x0 + x, cell_columns);
        const float along = along_y * hat(at_x, column) * (is_side ? 1.0f : hat(at_x, column + right));
        const int t = y * TILE_SIDE + x;
        if (along == 0.0f || texel_weights[tile * TILE_TEXELS + t] == 0.0f) continue;
        float product = 0.0f;
        for (int c = 0; c < CHANNELS; ++c) {
          const int at = c * TILE_TEXELS + t;
          product = FMA(d[at], is_side ? convert_float(delta[at]) : e[at], product);
        }
        sum = FMA(along * texel_weights[tile * TILE_TEXELS + t], product, sum);
      }
    }
  }
  partial[(tile * (CELLS * CELLS) + cell) * ENTRIES + entry] = sum;
}
