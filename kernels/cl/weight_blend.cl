// weight_blend.cl - the weight maps of all expressions, blended with the blendshape weights (FaceZip, Eq. 8, bracket)
//   w_i(q) = sum over active n of beta_n W_n[i](q),   W = scale_i * code + offset_i
//          = scale_i * sum beta_n code + offset_i * sum beta_n, all of it times the cell's gain
//
// NDRange   global {blocks * 16 / LANES}, rounded up to the local size; a work-item has LANES cells of one block
// Buffers   codes     in   [blocks][N][C][16] uchar  16 neighbouring cells of the row-major cell grid are a block
//           active    in   [count]            int    expressions whose beta is not 0, rising
//           beta      in   [count]            float  their weights
//           encoding  in   [2][C]             float  scale_i, then offset_i * sum beta_n
//           weights   out  [blocks][C][16]    float
//           gain      in   [blocks][16]       float  1 where nobody tuned
// Defines   LANES        16 on CPUs (16), 1 on GPUs (neighbouring work-items read neighbouring bytes)
//           DIFFERENCES  C, 1 to 8 (4)
//           PREFETCH     1: codes are asked for a block ahead, where the compiler is clang (PoCL) (0)
// Sums      in rising n: same bits whichever range of blocks is asked for

#include "lanes.h"

#ifndef DIFFERENCES
#define DIFFERENCES 4
#endif
#ifndef PREFETCH
#define PREFETCH 0
#endif

typedef VECTOR(uchar) bytes;

kernel void weight_blend(global const uchar* restrict codes, global const int* restrict active,
                         global const float* restrict beta, global const float* restrict encoding,
                         global float* restrict weights, const int count, const int expressions, const ulong first_block,
                         const ulong block_count, global const float* restrict gain) {
  const ulong item = get_global_id(0);
  const ulong block = first_block + item / (16 / LANES);
  const uint lane = (uint)(item % (16 / LANES));
  if (block >= first_block + block_count) return;

  floats sum[DIFFERENCES];
  for (int i = 0; i < DIFFERENCES; ++i) sum[i] = 0.0f;
  for (int a = 0; a < count; ++a) {
    const float weight = beta[a];
    global const uchar* code = codes + ((block * (ulong)expressions + (ulong)active[a]) * DIFFERENCES * 16 + lane);
#if PREFETCH
    for (int byte = 0; byte < DIFFERENCES * 16; byte += 64) {
      __builtin_prefetch((const void*)(size_t)(code + expressions * DIFFERENCES * 16 + byte));
    }
#endif
    for (int i = 0; i < DIFFERENCES; ++i) {
      sum[i] = fma(TO_FLOATS(*(global const bytes*)(code + 16 * i)), weight, sum[i]);
    }
  }
  global float* out = weights + (block * DIFFERENCES * 16 + lane);
  const floats factor = *(global const floats*)(gain + (block * 16 + lane));
  for (int i = 0; i < DIFFERENCES; ++i) {
    *(global floats*)(out + 16 * i) = fma(sum[i], encoding[i], encoding[DIFFERENCES + i]) * factor;
  }
}
