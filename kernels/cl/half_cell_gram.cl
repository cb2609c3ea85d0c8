// half_cell_gram.cl - Gram matrices of the differences over the quarters of every cell of the weight grid
//   G_nm(h) = keep * G_nm(h) + metric_weight * sum over texels p of h of t(p) Delta_n(p) . Delta_m(p)
// A half cell h is a square of HALF x HALF texels, half a cell along each axis: inside it the weights hardly vary, and all
// that fitting them needs of its texels is this matrix (half_cell_fit.cl).
//
// NDRange  global {groups, half rows}, local {1, 1}: one work-item per 16 half cells side by side, HALF tiles wide
// Buffers  tile_at        in      [tile rows][tile columns] int   index of a tile of the band, -1 where there is none
//          texel_weights  in      [tile][256] float
//          differences    in      [tile][N][channel][256] DIFF_T, units of 1/255
//          grams          in out  [half row][group][m (m + 1) / 2 + n][16] float, n <= m; half rows from first_half_row on
// Defines  CHANNELS, DIFF_T  tiles.h
//          EXPRESSIONS       grid_weights.h
//          HALF              texels along a half cell: 2, 4, 8 or 16 (4)
// Sums     fixed order: rows and channels, pairs of neighbouring lanes; four rows at a time, tile by tile

#include "grid_weights.h"
#include "tiles.h"

#ifndef HALF
#define HALF 4
#endif

#define DIFFS JOIN(DIFF_T, 16)
#define BLOCK 4  // a register block is BLOCK x BLOCK products
#define BLOCKS ((EXPRESSIONS + BLOCK - 1) / BLOCK)
#define ROWS_AT_ONCE (HALF < 4 ? HALF : 4)
#define VALUES (ROWS_AT_ONCE * CHANNELS)
#define HALVES_OF_TILE (TILE_SIDE / HALF)
#if HALF == 2
typedef float8 halves;
#elif HALF == 4
typedef float4 halves;
#elif HALF == 8
typedef float2 halves;
#else
typedef float halves;
#endif

// Sums of HALF neighbouring lanes.
inline halves fold(const float16 v) {
  const float8 by2 = v.even + v.odd;
#if HALF == 2
  return by2;
#else
  const float4 by4 = by2.even + by2.odd;
#if HALF == 4
  return by4;
#else
  const float2 by8 = by4.even + by4.odd;
#if HALF == 8
  return by8;
#else
  return by8.x + by8.y;
#endif
#endif
#endif
}

// Differences of a few rows of a tile, times the root of the texels' weights; zeros past the last expression.
static void load_rows(global const DIFFS* restrict difference, global const float16* restrict texel_weights,
                      float16 values[BLOCKS * BLOCK][VALUES]) {
  float16 roots[ROWS_AT_ONCE];
  for (int y = 0; y < ROWS_AT_ONCE; ++y) roots[y] = sqrt(texel_weights[y]);
  for (int n = 0; n < EXPRESSIONS; ++n) {
#pragma unroll
    for (int c = 0; c < CHANNELS; ++c) {
#pragma unroll
      for (int y = 0; y < ROWS_AT_ONCE; ++y) {
        values[n][c * ROWS_AT_ONCE + y] = convert_float16(difference[(n * CHANNELS + c) * TILE_SIDE + y]) * roots[y];
      }
    }
  }
}

// Adds the products of rows of one tile to the half cells that they belong to.
static void add_products(const float16 values[BLOCKS * BLOCK][VALUES], const float metric_weight, const bool add,
                         global float* restrict grams) {
  for (int block_m = 0; block_m < BLOCKS; ++block_m) {
    for (int block_n = 0; block_n <= block_m; ++block_n) {
      float16 sums[BLOCK][BLOCK];
#pragma unroll
      for (int m = 0; m < BLOCK; ++m) {
#pragma unroll
        for (int n = 0; n < BLOCK; ++n) sums[m][n] = 0.0f;
      }
      for (int k = 0; k < VALUES; ++k) {
        float16 left[BLOCK];
#pragma unroll
        for (int n = 0; n < BLOCK; ++n) left[n] = values[block_n * BLOCK + n][k];
#pragma unroll
        for (int m = 0; m < BLOCK; ++m) {
          const float16 right = values[block_m * BLOCK + m][k];
#pragma unroll
          for (int n = 0; n < BLOCK; ++n) sums[m][n] = FMA(left[n], right, sums[m][n]);
        }
      }
#pragma unroll
      for (int m = 0; m < BLOCK; ++m) {
#pragma unroll
        for (int n = 0; n < BLOCK; ++n) {
          const int row = block_m * BLOCK + m;
          const int column = block_n * BLOCK + n;
          if (column > row || row >= EXPRESSIONS) continue;
          global halves* out = (global halves*)(grams + (row * (row + 1) / 2 + column) * 16);
          const halves sum = metric_weight * fold(sums[m][n]);
          *out = add ? *out + sum : sum;
        }
      }
    }
  }
}

kernel __attribute__((reqd_work_group_size(1, 1, 1))) void half_cell_gram(
    global const int* restrict tile_at, global const float16* restrict texel_weights,
    global const DIFFS* restrict differences, global float* restrict grams, const int tile_columns, const int tile_rows,
    const int first_row, const int first_half_row, const float metric_weight, const int keep) {
  const int group = (int)get_global_id(0);
  const int half_row = (int)get_global_id(1);
  const int pairs = EXPRESSIONS * (EXPRESSIONS + 1) / 2;
  grams += ((ulong)half_row * get_global_size(0) + group) * (ulong)(pairs * 16);
  const int row = (first_half_row + half_row) * HALF - first_row;  // of the band
  const int tile_row = row / TILE_SIDE;
  float16 values[BLOCKS * BLOCK][VALUES];
  for (int n = EXPRESSIONS; n < BLOCKS * BLOCK; ++n) {
    for (int k = 0; k < VALUES; ++k) values[n][k] = 0.0f;
  }
  for (int t = 0; t < HALF; ++t) {
    const int tile_column = group * HALF + t;
    const bool inside = row >= 0 && tile_row < tile_rows && tile_column < tile_columns;
    const int tile = inside ? tile_at[tile_row * tile_columns + tile_column] : -1;
    global float* out = grams + t * HALVES_OF_TILE;
    if (tile < 0) {
      for (int p = 0; p < (keep ? 0 : pairs); ++p) *(global halves*)(out + p * 16) = (halves)(0.0f);
      continue;
    }
    for (int y = 0; y < HALF; y += ROWS_AT_ONCE) {
      const int line = row % TILE_SIDE + y;
      load_rows(differences + (ulong)tile * (EXPRESSIONS * CHANNELS * TILE_SIDE) + line,
                texel_weights + (ulong)tile * TILE_SIDE + line, values);
      add_products(values, metric_weight, keep || y > 0, out);
    }
  }
}
