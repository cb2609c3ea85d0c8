// difference_texture_range.cl - smallest and largest value of the difference textures in each tile, for their encoding
//   ranges[tile][i][c] = (min, max) over the texels where a mask of the tile is above 0; (INFINITY, -INFINITY) if none is
//
// NDRange  global {tiles}, local {1}
// Buffers  mask_begin    in   [tile + 1] int
//          mask_weights  in   [entry][256] float   0..1, gutter included
//          textures      in   [tile][planes][256] float, plane = texture * channels + channel
//          ranges        out  [tile][planes] float2

#include "tiles.h"

// Rows of the tile that any mask covers, as 16 lanes of -1 (covered) or 0.
static void covered_rows(global const float16* masks, int count, int16* covered) {
  for (int r = 0; r < TILE_SIDE; ++r) {
    covered[r] = (int16)(0);
    for (int e = 0; e < count; ++e) covered[r] |= masks[e * TILE_SIDE + r] > (float16)(0.0f);
  }
}

kernel __attribute__((reqd_work_group_size(1, 1, 1))) void difference_texture_range(
    global const int* mask_begin, global const float16* mask_weights, global const float16* textures,
    global float2* ranges, int planes) {
  const ulong tile = get_global_id(0);
  int16 covered[TILE_SIDE];
  covered_rows(mask_weights + (ulong)mask_begin[tile] * TILE_SIDE, mask_begin[tile + 1] - mask_begin[tile], covered);
  for (int plane = 0; plane < planes; ++plane) {
    global const float16* rows = textures + (tile * planes + plane) * TILE_SIDE;
    float16 low = (float16)(INFINITY);
    float16 high = (float16)(-INFINITY);
    for (int r = 0; r < TILE_SIDE; ++r) {
      low = select(low, fmin(low, rows[r]), covered[r]);
      high = select(high, fmax(high, rows[r]), covered[r]);
    }
    const float8 low8 = fmin(low.lo, low.hi);
    const float4 low4 = fmin(low8.lo, low8.hi);
    const float8 high8 = fmax(high.lo, high.hi);
    const float4 high4 = fmax(high8.lo, high8.hi);
    ranges[tile * planes + plane] = (float2)(fmin(fmin(low4.x, low4.y), fmin(low4.z, low4.w)),
                                             fmax(fmax(high4.x, high4.y), fmax(high4.z, high4.w)));
  }
}
