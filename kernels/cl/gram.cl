// gram.cl - weighted Gram matrices of the differences, for CPUs (the sums behind FaceZip, Eq. 2, 3 and 4)
//   partial[row][b][4 i + j] = sum over the tiles of a run and their texels p of
//                              w_row(p) * sum_c Delta_{4I+i}(p, c) * Delta_{4J+j}(p, c),     w = t, t M_k^2 or t (M_k M_l)^2
// t is the texel weight. Block b = J (J + 1) / 2 + I, I <= J, is a 4 x 4 piece of the upper triangle of an N x N matrix;
// lanes past N repeat the last expression and are not used. A row is one matrix (slot) of one run; gram_reduce.cl adds
// the runs.
//
//   products of a part of a tile            times weights (broadcast)          sums in registers
//   P[p] = 16 lanes (i, j) of a block   x   W[slot][p]   8 slots at once   =   2 blocks x 8 slots x 16 lanes
//
// The products are formed once for all slots of a tile: with S slots that is 16 (S + channels) multiply-adds a texel
// and block, a third of one weighted product per slot. P and W of a part stay in the first-level cache.
//
// NDRange  global {runs}, local {1}
// Buffers  mask_begin     in   [tile + 1] int
//          mask_weights   in   [entry][256] float, 0..1
//          texel_weights  in   [tile][256] float
//          differences    in   [tile][N][channel][256] DIFF_T, units of 1/255
//          run_begin      in   [run + 1] int    tiles of a run
//          run_rows       in   [run + 1] int    rows of a run
//          slot_begin     in   [tile + 1] int   first entry of a tile in slots
//          slots          in   [entry] int2     row; masks a and b of the tile as (a + 1) | (b + 1) << 16, 0 for none
//          partial        out  [row][block_count][16] float
// Defines  CHANNELS, DIFF_T  tiles.h
//          PART_TEXELS       texels whose products are kept at a time, a multiple of 16 that divides 256 (64)
//          SLOT_CHUNK        slots whose weights are kept at a time, a multiple of 8 (64)
// Sums     fixed order: texels of a part, parts and tiles of a run

#include "tiles.h"

#ifndef PART_TEXELS
#define PART_TEXELS 64
#endif
#ifndef SLOT_CHUNK
#define SLOT_CHUNK 64
#endif
#define PART_ROWS (PART_TEXELS / TILE_SIDE)
#define SLOT_GROUP 8

// Writes weights of `count` slots for PART_ROWS rows from `row`: weights[group][row][slot in group][16]. The rest of the
// last group becomes 0.
static void slot_weights(global const int2* slots, int count, global const float* masks, global const float* texels,
                         float16* weights) {
  for (int s = 0; s < (count + SLOT_GROUP - 1) / SLOT_GROUP * SLOT_GROUP; ++s) {
    const int a = s < count ? slots[s].y & 0xffff : 0;
    const int b = s < count ? slots[s].y >> 16 : 0;
    float16* out = weights + (s / SLOT_GROUP) * PART_ROWS * SLOT_GROUP + s % SLOT_GROUP;
    for (int r = 0; r < PART_ROWS; ++r) {
      float16 weight = s < count ? vload16(r, texels) : (float16)(0.0f);
      float16 mask = (float16)(1.0f);
      if (a != 0) mask *= vload16(r, masks + (a - 1) * TILE_TEXELS);
      if (b != 0) mask *= vload16(r, masks + (b - 1) * TILE_TEXELS);
      out[r * SLOT_GROUP] = weight * (mask * mask);
    }
  }
}

// Interleaves two rows in pieces that stay inside a quarter of a register, one cheap instruction each:
// LOW (a0 b0 a1 b1 | a4 b4 a5 b5 | ...), HIGH (a2 b2 a3 b3 | a6 ...); the PAIRS forms do the same to pairs.
#define LOW(a, b)                                                                                 \
  (float16)(a.s0, b.s0, a.s1, b.s1, a.s4, b.s4, a.s5, b.s5, a.s8, b.s8, a.s9, b.s9, a.sc, b.sc, a.sd, b.sd)
#define HIGH(a, b)                                                                                \
  (float16)(a.s2, b.s2, a.s3, b.s3, a.s6, b.s6, a.s7, b.s7, a.sa, b.sa, a.sb, b.sb, a.se, b.se, a.sf, b.sf)
// Two floats at a time, as one 64-bit element: written in floats, compilers merge both rounds into slow four-way shuffles.
#define LOW_PAIRS(a, b) as_float16((ulong8)(a.s0, b.s0, a.s2, b.s2, a.s4, b.s4, a.s6, b.s6))
#define HIGH_PAIRS(a, b) as_float16((ulong8)(a.s1, b.s1, a.s3, b.s3, a.s5, b.s5, a.s7, b.s7))

// Transposes a part of four expressions: out[c][row][k] = the four differences of texels k, 4 + k, 8 + k and 12 + k.
static void load_block(global const DIFF_T* tile, int block, int expressions, float16* out) {
  const int n = 4 * block;
  const int last = expressions - 1;
  const int plane = CHANNELS * TILE_TEXELS;
  for (int c = 0; c < CHANNELS; ++c) {
    global const DIFF_T* x = tile + (ulong)c * TILE_TEXELS;
    for (int r = 0; r < PART_ROWS; ++r) {
      const float16 x0 = convert_float16(vload16(r, x + n * plane));
      const float16 x1 = convert_float16(vload16(r, x + min(n + 1, last) * plane));
      const float16 x2 = convert_float16(vload16(r, x + min(n + 2, last) * plane));
      const float16 x3 = convert_float16(vload16(r, x + min(n + 3, last) * plane));
      const ulong8 low01 = as_ulong8(LOW(x0, x1));
      const ulong8 high01 = as_ulong8(HIGH(x0, x1));
      const ulong8 low23 = as_ulong8(LOW(x2, x3));
      const ulong8 high23 = as_ulong8(HIGH(x2, x3));
      float16* o = out + (c * PART_ROWS + r) * 4;
      o[0] = LOW_PAIRS(low01, low23);
      o[1] = HIGH_PAIRS(low01, low23);
      o[2] = LOW_PAIRS(high01, high23);
      o[3] = HIGH_PAIRS(high01, high23);
    }
  }
}

// products[p] lane 4 i + j = sum_c left[c][p].i * right[c][p].j
static void block_products(const float16* left, const float4* right, float16* products) {
  for (int r = 0; r < PART_ROWS; ++r) {
    for (int k = 0; k < 4; ++k) {
      float16 p0 = (float16)(0.0f), p1 = (float16)(0.0f), p2 = (float16)(0.0f), p3 = (float16)(0.0f);
      for (int c = 0; c < CHANNELS; ++c) {
        const float16 a = left[(c * PART_ROWS + r) * 4 + k];
        const float4* b = right + ((c * PART_ROWS + r) * 4 + k) * 4;
        p0 = FMA(a.s0000111122223333, b[0].s0123012301230123, p0);
        p1 = FMA(a.s4444555566667777, b[1].s0123012301230123, p1);
        p2 = FMA(a.s88889999aaaabbbb, b[2].s0123012301230123, p2);
        p3 = FMA(a.sccccddddeeeeffff, b[3].s0123012301230123, p3);
      }
      products[r * TILE_SIDE + k] = p0;
      products[r * TILE_SIDE + 4 + k] = p1;
      products[r * TILE_SIDE + 8 + k] = p2;
      products[r * TILE_SIDE + 12 + k] = p3;
    }
  }
}

#define FOR_GROUP(step) step(0) step(1) step(2) step(3) step(4) step(5) step(6) step(7)

// Adds eight slots of two blocks: sixteen sums in registers, ten loads for sixteen multiply-adds.
static void add_group(const float16* first, const float16* second, const float* weights, global const int2* slots,
                      int count, global float16* partial, int block_count, int blocks) {
#define CLEAR(s) float16 a##s = (float16)(0.0f), b##s = (float16)(0.0f);
  FOR_GROUP(CLEAR)
  for (int r = 0; r < PART_ROWS; ++r) {
    const float* w = weights + r * SLOT_GROUP * TILE_SIDE;
    for (int t = 0; t < TILE_SIDE; ++t) {
      const float16 x = first[r * TILE_SIDE + t];
      const float16 y = second[r * TILE_SIDE + t];
#define ACCUMULATE(s)                                    \
  {                                                      \
    const float16 k = (float16)(w[s * TILE_SIDE + t]);   \
    a##s = FMA(x, k, a##s);                              \
    b##s = FMA(y, k, b##s);                              \
  }
      FOR_GROUP(ACCUMULATE)
    }
  }
#define STORE(s)                                                          \
  if (s < count) {                                                        \
    global float16* out = partial + (ulong)slots[s].x * (ulong)block_count; \
    out[0] += a##s;                                                       \
    if (blocks > 1) out[1] += b##s;                                       \
  }
  FOR_GROUP(STORE)
}

kernel __attribute__((reqd_work_group_size(1, 1, 1))) void gram(
    global const int* mask_begin, global const float* mask_weights, global const float* texel_weights,
    global const DIFF_T* differences, global const int* run_begin, global const int* run_rows,
    global const int* slot_begin, global const int2* slots, global float16* partial, int expressions, int first_block,
    int block_count) {
  float16 weights[SLOT_CHUNK * PART_ROWS];
  float16 left[CHANNELS * PART_TEXELS / 4];
  float16 right[CHANNELS * PART_TEXELS / 4];
  float16 products[2][PART_TEXELS];

  const int run = (int)get_global_id(0);
  for (ulong i = (ulong)run_rows[run] * block_count; i < (ulong)run_rows[run + 1] * block_count; ++i) {
    partial[i] = (float16)(0.0f);
  }
  int first_row = 0;  // of the matrix of blocks: block b = J (J + 1) / 2 + I
  while ((first_row + 1) * (first_row + 2) / 2 <= first_block) ++first_row;

  for (int tile = run_begin[run]; tile < run_begin[run + 1]; ++tile) {
    global const DIFF_T* tile_differences = differences + (ulong)tile * (ulong)expressions * CHANNELS * TILE_TEXELS;
    global const float* masks = mask_weights + (ulong)mask_begin[tile] * TILE_TEXELS;
    global const float* texels = texel_weights + (ulong)tile * TILE_TEXELS;
    for (int part = 0; part < TILE_TEXELS; part += PART_TEXELS) {
      for (int chunk = slot_begin[tile]; chunk < slot_begin[tile + 1]; chunk += SLOT_CHUNK) {
        const int count = min(SLOT_CHUNK, slot_begin[tile + 1] - chunk);
        slot_weights(slots + chunk, count, masks + part, texels + part, weights);
        int J = first_row;
        int I = first_block - J * (J + 1) / 2;
        int loaded = -1;
        for (int b = 0; b < block_count; b += 2) {
          const int blocks = min(2, block_count - b);
          for (int k = 0; k < blocks; ++k) {
            if (loaded != J) load_block(tile_differences + part, J, expressions, right);
            loaded = J;
            load_block(tile_differences + part, I, expressions, left);
            block_products(left, (const float4*)right, products[k]);
            if (++I > J) {
              I = 0;
              ++J;
            }
          }
          for (int s = 0; s < count; s += SLOT_GROUP) {
            add_group(products[0], products[blocks - 1], (const float*)(weights + s * PART_ROWS), slots + chunk + s,
                      min(SLOT_GROUP, count - s), partial + b, block_count, blocks);
          }
        }
      }
    }
  }
}
