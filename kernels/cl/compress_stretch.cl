// compress_stretch.cl - compress and stretch maps of a band, as differences to the neutral (Li et al. 2020, Eq. 13)
//   textures[tile][i][c][t] = active(t) sum_n I_ni(t) Delta_n(t, c),   i = 0: compression, 1: stretch
// I_ni are the normalised influences, interpolated linearly from the weight grid as the run time does. Where they sum to 1
// over n this is the weighted mean of the expressions' textures, less the neutral.
//
// NDRange  global {256 / ROWS, tiles}, local {256 / ROWS, 1}: one work-item per ROWS texels of a column
// Buffers  tiles        in   [tile] int2        column of tiles in the image, row of tiles in the band
//          active       in   [tile][256] float  1 where a texture is wanted (gutter included), else 0
//          differences  in   [tile][EXPRESSIONS][channel][256] DIFF_T, units of 1/255
//          influence    in   [cell row][cell column][TEXTURES][EXPRESSION_LANES] float, cell rows from first_cell_row on
//          textures     out  [tile][TEXTURES][channel][256] float, units of 1/255
// Defines  CHANNELS, DIFF_T                         tiles.h
//          TEXTURES, EXPRESSIONS, EXPRESSION_LANES  grid_weights.h
//          WEIGHT_SCALE                             weight_grid.h
//          ROWS                                     1, 2, 4, 8 or 16 (16)
// Sums     expressions in order

#include "grid_weights.h"
#include "tiles.h"
#include "weight_grid.h"

// Texels of a work-item, in a column: more share the look-up of their cells, on GPUs fewer fill the device.
#ifndef ROWS
#define ROWS 16
#endif

kernel void compress_stretch(global const int2* tiles, global const float* active, global const DIFF_T* differences,
                             global const float* influence, global float* textures, const int first_row,
                             const int first_cell_row, const int cell_columns, const int cell_rows) {
  const int column = (int)get_global_id(0) % TILE_SIDE;
  const int top = (int)get_global_id(0) / TILE_SIDE * ROWS;
  const ulong tile = get_global_id(1);
  const float x = cell_position(tiles[tile].x * TILE_SIDE + column, cell_columns);
  const int left = (int)x;
  const float right_share = x - (float)left;
  const ulong right_step = left + 1 < cell_columns ? CELL_FLOATS : 0;
  for (int row = top; row < top + ROWS; ++row) {
    const int t = row * TILE_SIDE + column;
    const float y = cell_position(first_row + tiles[tile].y * TILE_SIDE + row, cell_rows);
    const int upper = (int)y;
    const float lower_share = y - (float)upper;
    const ulong lower_step = upper + 1 < cell_rows ? (ulong)cell_columns * CELL_FLOATS : 0;
    const bool wanted = active[tile * TILE_TEXELS + t] > 0.0f;
    // Texels that hang over the image's edge have no cells of their own in the window.
    global const float* cell =
        influence + (wanted ? ((ulong)(upper - first_cell_row) * cell_columns + left) * CELL_FLOATS : 0);
    global const DIFF_T* difference = differences + tile * (ulong)EXPRESSIONS * CHANNELS * TILE_TEXELS + t;
    float sum[TEXTURES * CHANNELS];
    for (int i = 0; i < TEXTURES * CHANNELS; ++i) sum[i] = 0.0f;
    for (int n = 0; wanted && n < EXPRESSIONS; ++n) {
      float value[CHANNELS];
      for (int c = 0; c < CHANNELS; ++c) value[c] = (float)difference[(n * CHANNELS + c) * TILE_TEXELS];
      for (int i = 0; i < TEXTURES; ++i) {
        global const float* corner = cell + i * EXPRESSION_LANES + n;
        const float above = mix(corner[0], corner[right_step], right_share);
        const float below = mix(corner[lower_step], corner[lower_step + right_step], right_share);
        const float weight = mix(above, below, lower_share);
        for (int c = 0; c < CHANNELS; ++c) sum[i * CHANNELS + c] = FMA(weight, value[c], sum[i * CHANNELS + c]);
      }
    }
    for (int i = 0; i < TEXTURES * CHANNELS; ++i) {
      textures[(tile * TEXTURES * CHANNELS + i) * TILE_TEXELS + t] = sum[i];
    }
  }
}
