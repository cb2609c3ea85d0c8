// difference_texture.cl - the difference textures of a band (FaceZip, Eq. 5)
//   textures[tile][i][c][t] = sum_n (sum_k M_k(t) coefficients[k][i][n]) * Delta_n(t, c)
// The inner sum is the weight of expression n in texture i at texel t: formed once for all channels, four expressions at a
// time, so that a mask that was loaded serves four multiply-adds.
// NDRange  global {16, TEXTURES, tiles}, local {16, 1, 1}: one work-item per row of 16 texels of a tile and texture
// Buffers  mask_begin    in   [tile + 1] int
//          mask_index    in   [entry] int          mask k of an entry, 0 <= k < K
//          mask_weights  in   [entry][256] float   0..1, gutter included
//          coefficients  in   [K][TEXTURES][N rounded up to 4] float, 0 past N
//          differences   in   [tile][N][channel][256] DIFF_T, units of 1/255
//          textures      out  [tile][TEXTURES][channel][256] float, units of 1/255; 0 where no mask is active
// Defines  CHANNELS, DIFF_T  as in difference.cl
//          TEXTURES          C, 1 to 8
// Sums     fixed order: masks of the tile, then expressions

#ifndef CHANNELS
#define CHANNELS 3
#define DIFF_T short
#endif
#ifndef TEXTURES
#define TEXTURES 4
#endif
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define DIFF16 JOIN(DIFF_T, 16)

// Adds weight * Delta_n to the channels of a row.
static void add_expression(float16 weight, global const DIFF_T* difference, float16* sum) {
  for (int c = 0; c < CHANNELS; ++c) {
    sum[c] = FMA(weight, convert_float16(*(global const DIFF16*)(difference + c * TILE_TEXELS)), sum[c]);
  }
}

kernel void difference_texture(global const int* mask_begin, global const int* mask_index,
                               global const float* mask_weights, global const float* coefficients,
                               global const DIFF_T* differences, global float* textures, int expressions) {
  const int row = (int)get_global_id(0);
  const int texture = (int)get_global_id(1);
  const ulong tile = get_global_id(2);
  const int padded = (expressions + 3) / 4 * 4;
  const int begin = mask_begin[tile];
  const int end = mask_begin[tile + 1];
  global const DIFF_T* tile_row =
      differences + tile * (ulong)expressions * CHANNELS * TILE_TEXELS + (ulong)row * TILE_SIDE;

  float16 sum[CHANNELS];
  for (int c = 0; c < CHANNELS; ++c) sum[c] = (float16)(0.0f);
  for (int n = 0; n < expressions; n += 4) {
    float16 w0 = (float16)(0.0f), w1 = (float16)(0.0f), w2 = (float16)(0.0f), w3 = (float16)(0.0f);
    for (int e = begin; e < end; ++e) {
      const float16 mask = *(global const float16*)(mask_weights + (ulong)e * TILE_TEXELS + row * TILE_SIDE);
      global const float* a = coefficients + ((ulong)mask_index[e] * TEXTURES + texture) * padded + n;
      w0 = FMA(mask, (float16)(a[0]), w0);
      w1 = FMA(mask, (float16)(a[1]), w1);
      w2 = FMA(mask, (float16)(a[2]), w2);
      w3 = FMA(mask, (float16)(a[3]), w3);
    }
    global const DIFF_T* difference = tile_row + (ulong)n * CHANNELS * TILE_TEXELS;
    add_expression(w0, difference, sum);
    if (n + 1 < expressions) add_expression(w1, difference + CHANNELS * TILE_TEXELS, sum);
    if (n + 2 < expressions) add_expression(w2, difference + 2 * CHANNELS * TILE_TEXELS, sum);
    if (n + 3 < expressions) add_expression(w3, difference + 3 * CHANNELS * TILE_TEXELS, sum);
  }
  global float16* out =
      (global float16*)(textures + (tile * TEXTURES + texture) * CHANNELS * TILE_TEXELS + row * TILE_SIDE);
  for (int c = 0; c < CHANNELS; ++c) out[c * TILE_SIDE] = sum[c];
}
