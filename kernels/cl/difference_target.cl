// difference_target.cl - what texture i should be, when those behind it are coded: at every texel the best that the
// decoded textures leave to ask for, in code units. Blocks are then fitted to it, and what they decode to takes its place.
//   D_i = (y_i - sum_{j > i} L_ji D_j) / L_ii,   D_j = scale_j (code_j - zero_j)
//
// NDRange  global {256 / LANES, tiles}, local any
// Buffers  factors   in      [tile][FACTOR_PLANES][256] float  difference_factors.h
//          encoding  in      [C][channel] float2               scale, zero code
//          codes     in out  [tile][C][channel][256] float     texture i is written, those behind it are read
// Defines  CHANNELS  tiles.h
//          TEXTURES  grid_weights.h
//          LANES     lanes.h

#include "difference_factors.h"
#include "lanes.h"

#define PLANE (TILE_TEXELS / LANES)

kernel void difference_target(global const floats* restrict factors, global const float2* restrict encoding,
                              global floats* restrict codes, const int texture) {
  const int line = (int)get_global_id(0);
  const ulong tile = get_global_id(1);
  factors += tile * (ulong)(FACTOR_PLANES * PLANE) + line;
  codes += tile * (ulong)(TEXTURES * CHANNELS * PLANE) + line;
  const floats inverse = factors[LOWER(texture, texture) * PLANE];
#pragma unroll
  for (int c = 0; c < CHANNELS; ++c) {
    floats value = factors[(SIDE_PLANES + texture * CHANNELS + c) * PLANE];
    for (int j = texture + 1; j < TEXTURES; ++j) {
      const float2 of_j = encoding[j * CHANNELS + c];
      const floats d = (codes[(j * CHANNELS + c) * PLANE] - of_j.y) * of_j.x;
      value -= factors[LOWER(j, texture) * PLANE] * d;
    }
    const float2 code = encoding[texture * CHANNELS + c];
    const float steps = code.x > 0.0f ? 1.0f / code.x : 0.0f;
    codes[(texture * CHANNELS + c) * PLANE] = FMA(value * inverse, (floats)(steps), (floats)(code.y));
  }
}
