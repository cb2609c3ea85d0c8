// difference_texture.cl - the difference textures of a band (FaceZip, Eq. 5)
//   textures[tile][i][c][t] = sum_n (sum_k M_k(t) coefficients[k][n][i]) * Delta_n(t, c)
// The inner sum is the weight of expression n in texture i at texel t. A work-item keeps all textures and channels of its
// texels in registers: a mask that was loaded serves 2 * TEXTURES multiply-adds, a difference TEXTURES of them.
//
// NDRange  global {256 / WIDTH, tiles}, local {256 / WIDTH, 1}: one work-item per WIDTH texels of a row
// Buffers  mask_begin    in   [tile + 1] int
//          mask_index    in   [entry] int          mask k of an entry, 0 <= k < K
//          mask_weights  in   [entry][256] float   0..1, gutter included
//          coefficients  in   [K][N rounded up to 2][TEXTURES] float, 0 past N
//          differences   in   [tile][N][channel][256] DIFF_T, units of 1/255
//          textures      out  [tile][TEXTURES][channel][256] float, units of 1/255; 0 where no mask is active
// Defines  CHANNELS, DIFF_T  tiles.h
//          TEXTURES          C, 1 to 8 (4)
//          WIDTH             texels of a work-item: 16 fills the registers of a CPU (16), 4 keeps to those of a GPU's
// Sums     fixed order: masks of the tile, then expressions; the same for every WIDTH

#include "tiles.h"

#ifndef TEXTURES
#define TEXTURES 4
#endif
#ifndef WIDTH
#define WIDTH 16
#endif
#define FLOATS JOIN(float, WIDTH)
#define DIFFS JOIN(DIFF_T, WIDTH)
#define CONVERT JOIN(convert_float, WIDTH)
#define PLANE (TILE_TEXELS / WIDTH)  // vectors between the planes of a tile

// Adds weights * Delta_n to every texture and channel.
static void add_expression(const FLOATS* weights, global const DIFFS* difference, FLOATS* sum) {
#pragma unroll
  for (int c = 0; c < CHANNELS; ++c) {
    const FLOATS x = CONVERT(difference[c * PLANE]);
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) sum[i * CHANNELS + c] = FMA(weights[i], x, sum[i * CHANNELS + c]);
  }
}

kernel void difference_texture(global const int* mask_begin, global const int* mask_index,
                               global const FLOATS* mask_weights, global const float* coefficients,
                               global const DIFFS* differences, global FLOATS* textures, int expressions) {
  const ulong item = get_global_id(0);
  const ulong tile = get_global_id(1);
  const ulong mask_stride = (ulong)((expressions + 1) / 2 * 2) * TEXTURES;
  const int begin = mask_begin[tile];
  const int end = mask_begin[tile + 1];
  global const DIFFS* difference = differences + tile * (ulong)expressions * CHANNELS * PLANE + item;

  FLOATS sum[TEXTURES * CHANNELS];
#pragma unroll
  for (int i = 0; i < TEXTURES * CHANNELS; ++i) sum[i] = (FLOATS)(0.0f);
  for (int n = 0; n < expressions; n += 2) {
    FLOATS weights[2 * TEXTURES];
#pragma unroll
    for (int i = 0; i < 2 * TEXTURES; ++i) weights[i] = (FLOATS)(0.0f);
    for (int e = begin; e < end; ++e) {
      const FLOATS mask = mask_weights[(ulong)e * PLANE + item];
      global const float* a = coefficients + (ulong)mask_index[e] * mask_stride + n * TEXTURES;
#pragma unroll
      for (int i = 0; i < 2 * TEXTURES; ++i) weights[i] = FMA(mask, (FLOATS)(a[i]), weights[i]);
    }
    add_expression(weights, difference, sum);
    difference += CHANNELS * PLANE;
    if (n + 1 < expressions) add_expression(weights + TEXTURES, difference, sum);
    difference += CHANNELS * PLANE;
  }
#pragma unroll
  for (int i = 0; i < TEXTURES * CHANNELS; ++i) textures[(tile * TEXTURES * CHANNELS + i) * PLANE + item] = sum[i];
}
