// weight_system.cl - normal equations of the grid weights under given difference textures, for CPUs
//   sum_p t(p) h_q(p) h_q'(p) D(p) D(p)^T W_n(q') = sum_p t(p) h_q(p) D(p) Delta_n(p)        for every cell q, summed over q'
// h_q is the bilinear hat of cell q, t the weight of a texel; the matrix is the same for every expression. Hats are
// products of one along x and one along y, so both diagonal couplings of four cells are equal and D D^T is symmetric: 4
// blocks of C (C + 1) / 2 numbers a cell hold the matrix.
// weight_system    sums over one tile, for the cells that its texels interpolate between
// weight_system_gather.cl adds the tiles up
//
// NDRange  global {1, tiles}, local {1, 1}
// Buffers  tiles          in   [tile] int2
//          texel_weights  in   [tile][256] float
//          differences    in   [tile][N][channel][256] DIFF_T, units of 1/255
//          textures       in   [tile][C][channel][256] float, D in units of 1/255
//          partial        out  [tile][CELLS_OF_16 rows][CELLS_OF_16 columns][ENTRIES] float: blocks (self; right; below;
//                              diagonal) of C (C + 1) / 2, rounded up to 16; then the right-hand sides [C][lanes]
// Defines  CHANNELS, DIFF_T                         tiles.h
//          TEXTURES, EXPRESSIONS, EXPRESSION_LANES  grid_weights.h
//          WEIGHT_SCALE                             weight_grid.h
// Sums     fixed order: rows, then lanes

#include "grid_weights.h"
#include "tiles.h"
#include "weight_grid.h"

#define DIFFS JOIN(DIFF_T, 16)
#define CELLS CELLS_OF_16

// How the rows of the tile lie between rows of cells.
typedef struct {
  int cell[TILE_SIDE];        // row of cells above, counted from the tile's first
  float fraction[TILE_SIDE];  // how far down to the next
} Rows;

// The blocks: products of the textures, summed down the rows first and then along each pair of hats.
static void add_blocks(const Rows* rows, const float16* hats, global const float16* restrict texel_weights,
                       global const float16* restrict textures, global float* restrict partial) {
  float16 same[CELLS][PAIRS];   // both cells in row r
  float16 below[CELLS][PAIRS];  // one in row r, one in r + 1
  for (int r = 0; r < CELLS; ++r) {
    for (int p = 0; p < PAIRS; ++p) same[r][p] = below[r][p] = 0.0f;
  }
  for (int y = 0; y < TILE_SIDE; ++y) {
    const int r = rows->cell[y];
    const float f = rows->fraction[y];
    const float g = 1.0f - f;
    for (int i = 0; i < TEXTURES; ++i) {
      for (int j = 0; j <= i; ++j) {
        float16 product = 0.0f;
        for (int c = 0; c < CHANNELS; ++c) {
          product = FMA(textures[(i * CHANNELS + c) * TILE_SIDE + y], textures[(j * CHANNELS + c) * TILE_SIDE + y], product);
        }
        product *= texel_weights[y];
        const int p = LOWER(i, j);
        same[r][p] += g * g * product;
        below[r][p] += g * f * product;
        if (r + 1 < CELLS) same[r + 1][p] += f * f * product;
      }
    }
  }
  for (int r = 0; r < CELLS; ++r) {
    for (int j = 0; j < CELLS; ++j) {
      global float* out = partial + (r * CELLS + j) * ENTRIES;
      const float16 alone = hats[j] * hats[j];
      const float16 beside = j + 1 < CELLS ? hats[j] * hats[j + 1] : (float16)(0.0f);
      for (int p = 0; p < PAIRS; ++p) {
        out[p] = sum_of_16(same[r][p] * alone);
        out[PAIRS + p] = sum_of_16(same[r][p] * beside);
        out[2 * PAIRS + p] = sum_of_16(below[r][p] * alone);
        out[3 * PAIRS + p] = sum_of_16(below[r][p] * beside);
      }
      for (int p = 4 * PAIRS; p < BLOCKS_END; ++p) out[p] = 0.0f;
    }
  }
}

// The right-hand sides of expression n.
static void add_sides(const Rows* rows, const float16* hats, global const float16* restrict texel_weights,
                      global const float16* restrict textures, global const DIFFS* restrict difference,
                      global float* restrict partial) {
  float16 sides[CELLS + 1][TEXTURES];
  for (int r = 0; r <= CELLS; ++r) {
    for (int i = 0; i < TEXTURES; ++i) sides[r][i] = 0.0f;
  }
  for (int y = 0; y < TILE_SIDE;) {
    const int r = rows->cell[y];
    float16 upper[TEXTURES];
    float16 lower[TEXTURES];
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) upper[i] = lower[i] = 0.0f;
    for (; y < TILE_SIDE && rows->cell[y] == r; ++y) {
      const float f = rows->fraction[y];
      float16 delta[CHANNELS];
#pragma unroll
      for (int c = 0; c < CHANNELS; ++c) delta[c] = convert_float16(difference[c * TILE_SIDE + y]) * texel_weights[y];
#pragma unroll
      for (int i = 0; i < TEXTURES; ++i) {
        float16 product = 0.0f;
#pragma unroll
        for (int c = 0; c < CHANNELS; ++c) product = FMA(textures[(i * CHANNELS + c) * TILE_SIDE + y], delta[c], product);
        upper[i] = FMA((float16)(1.0f - f), product, upper[i]);
        lower[i] = FMA((float16)(f), product, lower[i]);
      }
    }
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) {
      sides[r][i] += upper[i];
      sides[r + 1][i] += lower[i];
    }
  }
  for (int r = 0; r < CELLS; ++r) {
    for (int j = 0; j < CELLS; ++j) {
      global float* out = partial + (r * CELLS + j) * ENTRIES + BLOCKS_END;
      for (int i = 0; i < TEXTURES; ++i) out[i * EXPRESSION_LANES] = sum_of_16(sides[r][i] * hats[j]);
    }
  }
}

kernel __attribute__((reqd_work_group_size(1, 1, 1))) void weight_system(
    global const int2* restrict tiles, global const float16* restrict texel_weights,
    global const DIFFS* restrict differences, global const float16* restrict textures, global float* restrict partial,
    const int first_row, const int cell_columns, const int cell_rows) {
  const ulong tile = get_global_id(1);
  const int x0 = tiles[tile].x * TILE_SIDE;
  const int y0 = first_row + tiles[tile].y * TILE_SIDE;
  const int first_cell = (int)cell_position(y0, cell_rows);
  Rows rows;
  for (int y = 0; y < TILE_SIDE; ++y) {
    const float position = cell_position(y0 + y, cell_rows);
    rows.cell[y] = (int)position - first_cell;
    rows.fraction[y] = position - (float)(int)position;
  }
  const int first_column = (int)cell_position(x0, cell_columns);
  const float16 position = cell_positions_of_16(x0, first_column, cell_columns);
  float16 hats[CELLS];
  for (int j = 0; j < CELLS; ++j) hats[j] = fmax(1.0f - fabs(position - (float)j), 0.0f);

  texel_weights += tile * TILE_SIDE;
  textures += tile * (TEXTURES * CHANNELS * TILE_SIDE);
  partial += tile * (ulong)(CELLS * CELLS * ENTRIES);
  add_blocks(&rows, hats, texel_weights, textures, partial);
  for (int n = 0; n < EXPRESSIONS; ++n) {
    add_sides(&rows, hats, texel_weights, textures,
              differences + (tile * EXPRESSIONS + n) * (ulong)(CHANNELS * TILE_SIDE), partial + n);
  }
  // Lanes past N are never read for a result; zeros keep them from being anything but zeros.
  for (int cell = 0; cell < CELLS * CELLS; ++cell) {
    for (int i = 0; i < TEXTURES; ++i) {
      for (int n = EXPRESSIONS; n < EXPRESSION_LANES; ++n) {
        partial[cell * ENTRIES + BLOCKS_END + i * EXPRESSION_LANES + n] = 0.0f;
      }
    }
  }
}
