// weight_map.cl - weights of the difference textures, for every expression and cell of the weight grid (FaceZip Eq. 6)
//   W_in(cell) = sum over masks k that give texture i to expression n of M_k(cell)
//
// NDRange  global {roundUp(cells, WGS), blocks}, local {WGS, 1}: work-item = one cell and 16 expressions, its
//          lanes; neighbouring work-items write neighbouring bytes
// Buffers  cell_begin    in   [cells + 1] int             entries of a cell, counted from `first_entry`
//          mask_index    in   [entries] int               k
//          mask_weights  in   [entries] float             M_k(cell), 0..1; sums to 1 over a cell
//          texture_of    in   [masks][blocks * 16] int    i that expression n uses under mask k, -1 where padded
//          weights       out  [expressions][cells][C] uchar   floor(255 W + 1/2), at most 255
// Defines  CLUSTERS      C, 1 to 8 (4)

#ifndef CLUSTERS
#define CLUSTERS 4
#endif
#define LANES 16

kernel void weight_map(global const int* restrict cell_begin, global const int* restrict mask_index,
                       global const float* restrict mask_weights, global const int* restrict texture_of,
                       global uchar* restrict weights, ulong cells, int expressions, int first_entry) {
  const ulong cell = get_global_id(0);
  if (cell >= cells) return;
  const int block = (int)get_global_id(1);
  const int blocks = (int)get_global_size(1);

  float16 sums[CLUSTERS];
  for (int i = 0; i < CLUSTERS; ++i) sums[i] = (float16)(0.0f);
  const int end = cell_begin[cell + 1] - first_entry;
  for (int entry = cell_begin[cell] - first_entry; entry < end; ++entry) {
    const int16 texture = vload16((ulong)mask_index[entry] * blocks + block, texture_of);
    const float16 weight = (float16)(mask_weights[entry]);
    for (int i = 0; i < CLUSTERS; ++i) sums[i] += select((float16)(0.0f), weight, texture == (int16)(i));
  }

  const int first = block * LANES;
  const int count = min(LANES, expressions - first);
  for (int i = 0; i < CLUSTERS; ++i) {
    uchar bytes[LANES];
    vstore16(convert_uchar16(clamp(255.0f * sums[i] + 0.5f, 0.0f, 255.0f)), 0, bytes);
    for (int n = 0; n < count; ++n) weights[((ulong)(first + n) * cells + cell) * CLUSTERS + i] = bytes[n];
  }
}
