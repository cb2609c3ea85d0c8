// weight_map.cl - weights of the difference textures, for every expression and cell of the weight grid (FaceZip Eq. 6)
//   W_in(cell) = sum over masks k that give texture i to expression n of M_k(cell)
//
// NDRange  global {roundUp(cells / 16, WGS), blocks}, local {WGS, 1}: work-item = 16 cells and 16 expressions,
//          its lanes. With C = 4 it writes a line of 64 bytes per expression; a cell at a time it would touch 16 lines
//          for 4 bytes each, often a power of two apart, which took four to five times as long on PoCL
// Buffers  cell_begin    in   [cells + 1] int             entries of a cell, counted from `first_entry`
//          mask_index    in   [entries] int               k
//          mask_weights  in   [entries] float             M_k(cell), 0..1; sums to 1 over a cell
//          texture_of    in   [masks][blocks * 16] int    i that expression n uses under mask k, -1 where padded
//          weights       out  [expressions][cells][C] uchar   floor(255 W + 1/2), at most 255
// Defines  CLUSTERS      C, 1 to 8 (4)

#include "common.h"

#ifndef CLUSTERS
#define CLUSTERS 4
#endif
#define LANES FACEZIP_VECTOR
#define CELLS FACEZIP_WEIGHT_MAP_CELLS
// Four bytes travel as one int, the first in the lowest byte.
#if CLUSTERS == 4 && defined(__ENDIAN_LITTLE__)
#define PACKED
#define WORD int
#define WORDS 1
#else
#define WORD uchar
#define WORDS CLUSTERS
#endif

// 255 W + 1/2 of 16 expressions for every texture at one cell, in 0 .. 255.999; a uchar cuts it to the byte.
void cell_weights(global const int* mask_index, global const float* mask_weights, global const int* texture_of,
                  int begin, int end, int block, int blocks, float16* weights) {
  for (int i = 0; i < CLUSTERS; ++i) weights[i] = (float16)(0.0f);
  for (int entry = begin; entry < end; ++entry) {
    const int16 texture = vload16((ulong)mask_index[entry] * blocks + block, texture_of);
    const float16 weight = (float16)(mask_weights[entry]);
    for (int i = 0; i < CLUSTERS; ++i) weights[i] += select((float16)(0.0f), weight, texture == (int16)(i));
  }
  for (int i = 0; i < CLUSTERS; ++i) weights[i] = clamp(255.0f * weights[i] + 0.5f, 0.0f, 255.0f);
}

kernel void weight_map(global const int* restrict cell_begin, global const int* restrict mask_index,
                       global const float* restrict mask_weights, global const int* restrict texture_of,
                       global uchar* restrict weights, ulong cells, int expressions, int first_entry) {
  const ulong first_cell = get_global_id(0) * CELLS;
  if (first_cell >= cells) return;
  const int block = (int)get_global_id(1);
  const int cell_count = (int)min((ulong)CELLS, cells - first_cell);
  const int first = block * LANES;
  const int count = min(LANES, expressions - first);

  int bytes[CELLS * WORDS * LANES];
  for (int c = 0; c < cell_count; ++c) {
    const int begin = cell_begin[first_cell + c] - first_entry;
    const int end = cell_begin[first_cell + c + 1] - first_entry;
    float16 sums[CLUSTERS];
    cell_weights(mask_index, mask_weights, texture_of, begin, end, block, (int)get_global_size(1), sums);
#ifdef PACKED
    vstore16(convert_int16(sums[0]) | convert_int16(sums[1]) << 8 | convert_int16(sums[2]) << 16 |
                 convert_int16(sums[3]) << 24, c, bytes);
#else
    for (int i = 0; i < CLUSTERS; ++i) vstore16(convert_int16(sums[i]), c * CLUSTERS + i, bytes);
#endif
  }
  for (int n = 0; n < count; ++n) {
    global WORD* out = (global WORD*)weights + ((first + n) * cells + first_cell) * WORDS;
    for (int i = 0; i < cell_count * WORDS; ++i) out[i] = (WORD)bytes[i * LANES + n];
  }
}
