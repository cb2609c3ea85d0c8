// gram_gpu.cl - weighted Gram matrices of the differences, for GPUs: the same sums, rows, blocks and buffers as gram.cl
//   partial[row][b][4 i + j] = sum over the tiles of a run and their texels p of
//                              w_row(p) * sum_c Delta_{4I+i}(p, c) * Delta_{4J+j}(p, c),     w = t, t M_k^2 or t (M_k M_l)^2
// A work-group does one block of one run, WGS texels at a time: each work-item forms the 16 products and the SLOTS weights
// of one texel in local memory; then work-item (lane, g) adds up lane of the block under the slots 8 g .. 8 g + 7:
// three local loads (one product, two float4 of weights shared by 16 neighbours) for eight multiply-adds.
//
// NDRange  global {WGS * block_count, runs}, local {WGS, 1}
// Buffers  as gram.cl
// Defines  CHANNELS, DIFF_T  tiles.h
//          WGS               work-group size: 16, 32 or 64; 16 lanes times WGS / 16 groups of slots (64)
// Local    4 * WGS * (17 + SLOTS + 4) bytes, 13.6 KB at WGS 64
// Sums     fixed order: texels of a tile, tiles of a run. No float atomics.
// The speed on a GPU is reasoned, not measured: written for coalesced loads and few local accesses a multiply-add.

#include "tiles.h"

#ifndef WGS
#define WGS 64
#endif
#define LANES 16
#define SLOT_GROUP 8
#define SLOTS (WGS / LANES * SLOT_GROUP)
// One float more than the lanes: neighbouring texels write their products to different banks.
#define PRODUCT_STRIDE (LANES + 1)
// Four more than the slots: keeps float4 loads aligned and spreads the writes of neighbours over the banks.
#define WEIGHT_STRIDE (SLOTS + 4)

// Products of texel p of the tile: out[4 i + j] = sum_c Delta_{4I+i} * Delta_{4J+j}.
static void texel_products(global const DIFF_T* tile, int p, int I, int J, int expressions, local float* out) {
  float sum[LANES];
  for (int l = 0; l < LANES; ++l) sum[l] = 0.0f;
  for (int c = 0; c < CHANNELS; ++c) {
    float a[4];
    float b[4];
    for (int i = 0; i < 4; ++i) {
      const int n = min(4 * I + i, expressions - 1);
      const int m = min(4 * J + i, expressions - 1);
      a[i] = (float)tile[(n * CHANNELS + c) * TILE_TEXELS + p];
      b[i] = (float)tile[(m * CHANNELS + c) * TILE_TEXELS + p];
    }
    for (int l = 0; l < LANES; ++l) sum[l] = FMA(a[l / 4], b[l % 4], sum[l]);
  }
  for (int l = 0; l < LANES; ++l) out[l] = sum[l];
}

// Weights of texel p under `count` slots; the rest of SLOTS becomes 0.
static void texel_slot_weights(global const int2* slots, int count, global const float* masks, float texel, int p,
                               local float* out) {
  for (int s = 0; s < SLOTS; ++s) {
    const int a = s < count ? slots[s].y & 0xffff : 0;
    const int b = s < count ? slots[s].y >> 16 : 0;
    float mask = 1.0f;
    if (a != 0) mask *= masks[(a - 1) * TILE_TEXELS + p];
    if (b != 0) mask *= masks[(b - 1) * TILE_TEXELS + p];
    out[s] = s < count ? texel * (mask * mask) : 0.0f;
  }
}

kernel __attribute__((reqd_work_group_size(WGS, 1, 1))) void gram_gpu(
    global const int* mask_begin, global const float* mask_weights, global const float* texel_weights,
    global const DIFF_T* differences, global const int* run_begin, global const int* run_rows,
    global const int* slot_begin, global const int2* slots, global float* partial, int expressions, int first_block,
    int block_count) {
  local float products[WGS * PRODUCT_STRIDE];
  local float4 weights4[WGS * WEIGHT_STRIDE / 4];
  local float* weights = (local float*)weights4;

  const int item = (int)get_local_id(0);
  const int lane = item % LANES;
  const int group = item / LANES;
  const int block = (int)get_group_id(0);
  const int run = (int)get_group_id(1);
  int J = 0;  // block b = J (J + 1) / 2 + I
  while ((J + 1) * (J + 2) / 2 <= first_block + block) ++J;
  const int I = first_block + block - J * (J + 1) / 2;

  global float* out = partial + block * LANES + lane;
  const ulong row_stride = (ulong)block_count * LANES;
  for (int row = run_rows[run] + group; row < run_rows[run + 1]; row += WGS / LANES) out[row * row_stride] = 0.0f;
  barrier(CLK_GLOBAL_MEM_FENCE);

  for (int tile = run_begin[run]; tile < run_begin[run + 1]; ++tile) {
    global const DIFF_T* tile_differences = differences + (ulong)tile * (ulong)expressions * CHANNELS * TILE_TEXELS;
    global const float* masks = mask_weights + (ulong)mask_begin[tile] * TILE_TEXELS;
    global const float* texels = texel_weights + (ulong)tile * TILE_TEXELS;
    for (int chunk = slot_begin[tile]; chunk < slot_begin[tile + 1]; chunk += SLOTS) {
      const int count = min(SLOTS, slot_begin[tile + 1] - chunk);
      float sum[SLOT_GROUP];
      for (int s = 0; s < SLOT_GROUP; ++s) sum[s] = 0.0f;
      for (int first = 0; first < TILE_TEXELS; first += WGS) {
        const int p = first + item;
        texel_products(tile_differences, p, I, J, expressions, products + item * PRODUCT_STRIDE);
        texel_slot_weights(slots + chunk, count, masks, texels[p], p, weights + item * WEIGHT_STRIDE);
        barrier(CLK_LOCAL_MEM_FENCE);
#pragma unroll 4
        for (int q = 0; q < WGS; ++q) {
          const float product = products[q * PRODUCT_STRIDE + lane];
          const float4 low = weights4[q * (WEIGHT_STRIDE / 4) + group * 2];
          const float4 high = weights4[q * (WEIGHT_STRIDE / 4) + group * 2 + 1];
          sum[0] = FMA(product, low.x, sum[0]);
          sum[1] = FMA(product, low.y, sum[1]);
          sum[2] = FMA(product, low.z, sum[2]);
          sum[3] = FMA(product, low.w, sum[3]);
          sum[4] = FMA(product, high.x, sum[4]);
          sum[5] = FMA(product, high.y, sum[5]);
          sum[6] = FMA(product, high.z, sum[6]);
          sum[7] = FMA(product, high.w, sum[7]);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
      }
      for (int s = 0; s < SLOT_GROUP; ++s) {
        const int slot = group * SLOT_GROUP + s;
        if (slot < count) out[slots[chunk + slot].x * row_stride] += sum[s];
      }
      // The next tile may give a row to another work-item.
      barrier(CLK_GLOBAL_MEM_FENCE);
    }
  }
}
