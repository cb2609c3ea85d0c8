// difference_settle.cl - difference textures from their codes, and what they leave of the captured differences.
//   D_i = scale_i (code_i - zero_i),   error = left + |L^T D - y|^2 - ridge |D|^2     (difference_factors.h)
//
// NDRange  global {256 / LANES, tiles}, local any
// Buffers  factors        in   [tile][FACTOR_PLANES][256] float
//          encoding       in   [C][channel] float2      scale, zero code
//          codes          in   [tile][C][channel][256] float
//          texel_weights  in   [tile][256] float        weight of a texel in every sum, 0 outside the covered texels
//          textures       out  [tile][C][channel][256] float, units of 1/255
//          errors         out  [tile][256 / LANES] float2  sum over the item's covered texels: times the texel weight,
//                                                          and plain
// Defines  CHANNELS  tiles.h
//          TEXTURES  grid_weights.h
//          LANES     lanes.h
// Sums     lanes of an item in a fixed order

#include "difference_factors.h"
#include "lanes.h"

#define PLANE (TILE_TEXELS / LANES)
#if LANES == 1
#define SUM_LANES(value) (value)
#else
#define SUM_LANES sum_of_16
#endif

kernel void difference_settle(global const floats* restrict factors, global const float2* restrict encoding,
                              global const floats* restrict codes, global const floats* restrict texel_weights,
                              global floats* restrict textures, global float2* restrict errors, const float ridge) {
  const int line = (int)get_global_id(0);
  const ulong tile = get_global_id(1);
  factors += tile * (ulong)(FACTOR_PLANES * PLANE) + line;
  codes += tile * (ulong)(TEXTURES * CHANNELS * PLANE) + line;
  textures += tile * (ulong)(TEXTURES * CHANNELS * PLANE) + line;
  floats error = factors[LEFT_PLANE * PLANE];
  for (int c = 0; c < CHANNELS; ++c) {
    floats d[TEXTURES];
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) {
      const float2 code = encoding[i * CHANNELS + c];
      d[i] = (codes[(i * CHANNELS + c) * PLANE] - code.y) * code.x;
      textures[(i * CHANNELS + c) * PLANE] = d[i];
    }
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) {
      floats missed = d[i] / factors[LOWER(i, i) * PLANE] - factors[(SIDE_PLANES + i * CHANNELS + c) * PLANE];
#pragma unroll
      for (int j = i + 1; j < TEXTURES; ++j) missed = FMA(factors[LOWER(j, i) * PLANE], d[j], missed);
      error += missed * missed - ridge * d[i] * d[i];
    }
  }
  const floats weight = texel_weights[tile * PLANE + line];
  error = fmax(error, (floats)(0.0f));
  errors[tile * PLANE + get_global_id(0)] =
      (float2)(SUM_LANES(error * weight), SUM_LANES(weight > (floats)(0.0f) ? error : (floats)(0.0f)));
}
