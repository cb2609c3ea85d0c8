// difference_fit.cl - difference textures that suit given weights best: per texel and for all channels together
//   D = argmin sum_n |Delta_n - D^T w_n|^2 + ridge |D|^2,   w_n the bilinear weight map of expression n (FaceZip, Eq. 8)
// A C x C system per texel, by Cholesky. With CODES the textures are rounded to their encoding while the system is
// substituted back (Babai's nearest plane): a channel that is solved for after another makes up for that one's rounding.
// With FACTORS the systems are not solved but kept, for textures that are coded in blocks one after the other
// (difference_target.cl).
//
// NDRange  global {256 / (LANES * ROWS), tiles}, local {256 / (LANES * ROWS), 1}
// Buffers  tiles          in   [tile] int2        column and row of tiles in the band
//          texel_weights  in   [tile][256] float  weight of a texel in every sum, 0 outside the covered texels
//          active         in   [tile][256] float  above 0 where D is wanted (gutter too); elsewhere D becomes 0
//          differences    in   [tile][N][channel][256] DIFF_T, units of 1/255
//          weights        in   [row][column][C][lanes] float   W_n of the cell rows from first_cell_row on, n innermost
//          encoding       in   [C][channel] float2  scale, zero code (with CODES)
//          textures       out  [tile][C][channel][256] float, units of 1/255; with FACTORS
//                              [tile][FACTOR_PLANES][256] float as difference_factors.h has them
//          errors         out  [tile][item] float2  sum over the item's covered texels of |Delta - D^T w|^2: times the
//                                                   texel weight, and plain (not with FACTORS)
// Defines  CHANNELS, DIFF_T                         tiles.h
//          TEXTURES, EXPRESSIONS, EXPRESSION_LANES  grid_weights.h
//          WEIGHT_SCALE                             weight_grid.h
//          LANES, ROWS  texels of a work-item: 16 columns by 16 rows on CPUs (16, 16), one on GPUs
//          CODES        if set, the largest code: 255 or 65535
//          FACTORS      if set, that output
// Sums     fixed order: expressions; rows and lanes of an item

#include "cholesky.h"
#include "difference_factors.h"
#include "tiles.h"
#include "weight_grid.h"

#ifndef ROWS
#define ROWS 16
#endif

typedef VECTOR(int) ints;
typedef VECTOR(DIFF_T) diffs;
#if LANES == 1
#define SUM_LANES(value) (value)
#define CELL_COLUMNS 2
#else
#define SUM_LANES sum_of_16
#define CELL_COLUMNS CELLS_OF_16
#endif
#define PLANE (TILE_TEXELS / LANES)  // vectors between the planes of a tile

#if LANES == 1
// One weight at one texel. A work-item that has a single texel has no use for its neighbours' rows of cells.
static float texel_weight(global const float* restrict upper, global const float* restrict lower, const float* hats,
                          const float fraction, const int first_column, const int columns, const int entry) {
  float above = 0.0f;
  float below = 0.0f;
#pragma unroll
  for (int j = 0; j < CELL_COLUMNS; ++j) {
    const ulong at = (ulong)min(first_column + j, columns - 1) * CELL_FLOATS + entry;
    above = FMA(hats[j], upper[at], above);
    below = FMA(hats[j], lower[at], below);
  }
  return FMA(below - above, fraction, above);
}
#else
// Weights of all expressions on one row of cells, at the columns of the item's texels.
static void interpolate_columns(global const float* restrict cells, const floats* hats, const int first_column,
                                const int columns, floats weights[EXPRESSIONS][TEXTURES]) {
  for (int n = 0; n < EXPRESSIONS; ++n) {
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) weights[n][i] = 0.0f;
  }
  for (int j = 0; j < CELL_COLUMNS; ++j) {
    global const float* cell = cells + (ulong)min(first_column + j, columns - 1) * CELL_FLOATS;
    const floats hat = hats[j];
    for (int n = 0; n < EXPRESSIONS; ++n) {
#pragma unroll
      for (int i = 0; i < TEXTURES; ++i) weights[n][i] = FMA(hat, (floats)(cell[i * EXPRESSION_LANES + n]), weights[n][i]);
    }
  }
}

#endif

// x of L L^T x = b for one channel, in place.
static void solve(const floats l[PAIRS], floats x[TEXTURES], global const float2* restrict encoding, const int channel) {
  substitute_forward(l, x);
#pragma unroll
  for (int i = TEXTURES - 1; i >= 0; --i) {
    x[i] = substitute_back(l, x, i);
#ifdef CODES
    const float2 code = encoding[i * CHANNELS + channel];
    const float steps = code.x > 0.0f ? 1.0f / code.x : 0.0f;
    x[i] = (floor(clamp(x[i] * steps + code.y + 0.5f, 0.0f, (float)CODES)) - code.y) * code.x;
#endif
  }
}

// |Delta - D^T w|^2 summed over n, from the sums that the solution was made of: e - 2 b . D + D . A D.
static floats squared_error(const floats a[PAIRS], const floats b[TEXTURES][CHANNELS],
                            const floats d[TEXTURES][CHANNELS], const floats e) {
  floats error = e;
#pragma unroll
  for (int c = 0; c < CHANNELS; ++c) {
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) {
      floats gradient = a[LOWER(i, i)] * d[i][c] - 2.0f * b[i][c];
#pragma unroll
      for (int j = 0; j < i; ++j) gradient += 2.0f * a[LOWER(i, j)] * d[j][c];
      error += gradient * d[i][c];
    }
  }
  return fmax(error, (floats)(0.0f));
}

kernel void difference_fit(global const int2* restrict tiles, global const floats* restrict texel_weights,
                           global const floats* restrict active, global const diffs* restrict differences,
                           global const float* restrict weights, global const float2* restrict encoding,
                           global floats* restrict textures, global float2* restrict errors, const int first_row,
                           const int first_cell_row, const int cell_columns, const int cell_rows, const float ridge) {
  const int items = TILE_TEXELS / (LANES * ROWS);
  const int item = (int)get_global_id(0);
  const ulong tile = get_global_id(1);
  const int column = item * LANES % TILE_SIDE;
  const int row = item * LANES / TILE_SIDE * ROWS;
  const int x0 = tiles[tile].x * TILE_SIDE + column;
  const int y0 = first_row + tiles[tile].y * TILE_SIDE + row;

  const int first_column = (int)cell_position(x0, cell_columns);
  floats hats[CELL_COLUMNS];
#if LANES == 1
  const floats position = cell_position(x0, cell_columns) - (float)first_column;
#else
  const floats position = cell_positions_of_16(x0, first_column, cell_columns);
#endif
  for (int j = 0; j < CELL_COLUMNS; ++j) hats[j] = fmax(1.0f - fabs(position - (float)j), 0.0f);

#if LANES > 1
  floats above[EXPRESSIONS][TEXTURES];
  floats below[EXPRESSIONS][TEXTURES];
  int held = -1;  // row of cells in `above`
#endif
  float2 error_sum = (float2)(0.0f);
  for (int r = 0; r < ROWS; ++r) {
    const float cell_y = cell_position(y0 + r, cell_rows);
    const int cell_row = (int)cell_y;
    const float fraction = cell_y - (float)cell_row;
    const int next_row = min(cell_row + 1, cell_rows - 1);
    global const float* upper = weights + (ulong)(cell_row - first_cell_row) * cell_columns * CELL_FLOATS;
    global const float* lower = upper + (ulong)(next_row - cell_row) * cell_columns * CELL_FLOATS;
#if LANES > 1
    if (cell_row != held) {
      interpolate_columns(upper, hats, first_column, cell_columns, above);
      interpolate_columns(lower, hats, first_column, cell_columns, below);
      held = cell_row;
    }
#endif
    const int line = ((row + r) * TILE_SIDE + column) / LANES;
    global const diffs* difference = differences + tile * (ulong)(EXPRESSIONS * CHANNELS * PLANE) + line;
    floats a[PAIRS];
    floats b[TEXTURES][CHANNELS];
    floats e = 0.0f;
#pragma unroll
    for (int p = 0; p < PAIRS; ++p) a[p] = 0.0f;
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
      for (int c = 0; c < CHANNELS; ++c) b[i][c] = 0.0f;
    }
    for (int n = 0; n < EXPRESSIONS; ++n) {
      floats w[TEXTURES];
#pragma unroll
      for (int i = 0; i < TEXTURES; ++i) {
#if LANES > 1
        w[i] = FMA(below[n][i] - above[n][i], (floats)(fraction), above[n][i]);
#else
        w[i] = texel_weight(upper, lower, hats, fraction, first_column, cell_columns, i * EXPRESSION_LANES + n);
#endif
      }
#pragma unroll
      for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
        for (int j = 0; j <= i; ++j) a[LOWER(i, j)] = FMA(w[i], w[j], a[LOWER(i, j)]);
      }
#pragma unroll
      for (int c = 0; c < CHANNELS; ++c) {
        const floats delta = TO_FLOATS(difference[c * PLANE]);
        e = FMA(delta, delta, e);
#pragma unroll
        for (int i = 0; i < TEXTURES; ++i) b[i][c] = FMA(w[i], delta, b[i][c]);
      }
      difference += CHANNELS * PLANE;
    }

    floats l[PAIRS];
#pragma unroll
    for (int p = 0; p < PAIRS; ++p) l[p] = a[p];
    factor(l, ridge);
    const ints wanted = active[tile * PLANE + line] > (floats)(0.0f);
#ifdef FACTORS
    global floats* factors = textures + tile * (ulong)(FACTOR_PLANES * PLANE) + line;
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
      for (int j = 0; j <= i; ++j) {
        factors[LOWER(i, j) * PLANE] = wanted ? l[LOWER(i, j)] : (floats)(i == j ? 1.0f : 0.0f);
      }
    }
#pragma unroll
    for (int c = 0; c < CHANNELS; ++c) {
      floats y[TEXTURES];
#pragma unroll
      for (int i = 0; i < TEXTURES; ++i) y[i] = wanted ? b[i][c] : (floats)(0.0f);
      substitute_forward(l, y);
#pragma unroll
      for (int i = 0; i < TEXTURES; ++i) {
        factors[(SIDE_PLANES + i * CHANNELS + c) * PLANE] = y[i];
        e -= y[i] * y[i];
      }
    }
    factors[LEFT_PLANE * PLANE] = fmax(e, (floats)(0.0f));
#else
    floats d[TEXTURES][CHANNELS];
#pragma unroll
    for (int c = 0; c < CHANNELS; ++c) {
      floats x[TEXTURES];
#pragma unroll
      for (int i = 0; i < TEXTURES; ++i) x[i] = b[i][c];
      solve(l, x, encoding, c);
#pragma unroll
      for (int i = 0; i < TEXTURES; ++i) {
        d[i][c] = wanted ? x[i] : (floats)(0.0f);
        textures[(tile * (TEXTURES * CHANNELS) + i * CHANNELS + c) * PLANE + line] = d[i][c];
      }
    }
    const floats weight = texel_weights[tile * PLANE + line];
    const floats error = squared_error(a, b, d, e);
    error_sum.x += SUM_LANES(error * weight);
    error_sum.y += SUM_LANES(weight > (floats)(0.0f) ? error : (floats)(0.0f));
#endif
  }
  errors[tile * items + item] = error_sum;
}
