// bc7_encode.cl - BC7 blocks from texels. A line through the whole block (mode 6) is always fitted; of the other ways to
// code it those that moments of the texels promise most for (bc7_candidates.h): two or three lines, each through a subset
// of the texels, or one channel of its own beside a line (modes 0 to 5, with alpha 7). The best is kept.
//   minimises sum over texels t and channels c of weight_t * channel_weight_c * (texel - decoded)^2
// Without a fourth channel alpha decodes to 254 or 255.
// NDRange  global {blocks to visit / LANES or more}, local any; blocks as block_texels.h counts them
// Buffers  tiles     in   [tile] int2     with TILES: column and row of tiles; else not read
//          texels    in   TEXEL           laid out as `layout` says, code units 0 to 255
//          weights   in   float           with TEXEL_WEIGHTS: of texels, not below 0; else not read
//          blocks    out  [row][column] uint4   blocks_y rows of blocks_x
//          decoded   out  float           with DECODED: laid out like texels; else not written
// Defines  block_texels.h's
//          KEPT      ways that are fitted beside mode 6
//          DOUBT     ways are passed over in blocks where none of the lanes' costs, times this, is below the error so far
//          DOUBT     a way is passed over where no lane's cost, times this, is below its error so far
//          SCAN3     partitions into three subsets that are looked at, 0 to 64
//          ROUNDS    times that ends of lines are fitted to indices and indices to ends
//          NEARBY    1: of the two steps beside a texel the one that decodes nearer is taken; 0: the nearer one
//          SWEEPS    times that ends are moved by a step of their code
//          DECODED   if set, decoded texels are written

#ifndef CHANNELS
#define CHANNELS 3
#endif
#if CHANNELS == 4
#define DIMS 4
#else
#define DIMS 3
#endif
#ifndef KEPT
#define KEPT 2
#endif
#ifndef DOUBT
#define DOUBT 1.0f
#endif
#ifndef SCAN3
#define SCAN3 0
#endif
#ifndef ROUNDS
#define ROUNDS 1
#endif
#ifndef NEARBY
#define NEARBY 1
#endif
#ifndef SWEEPS
#define SWEEPS 0
#endif

#include "block_texels.h"
#include "bc7_tables.h"
#include "block_line.h"
#include "bc7_fit.h"
#include "bc7_candidates.h"
#include "bc7_pack.h"

// The block coded one way in each lane.
inline Choice code_way(const ints way, const floats* x, const floats* w, const floats mean[DIMS],
                       const floats scale[DIMS], const floats opaque_error) {
  const Fields fields = fields_of(way);
  Choice choice;
  choice.way = way;
  choice.error = fields.mode < 4 ? opaque_error : (floats)(0.0f);
  for (int part = 0; part < 3; ++part) {
    if (!has_part(fields, part)) continue;
    floats y[16 * DIMS], part_weights[16], part_mean[DIMS], part_scale[DIMS];
    part_texels(fields, part, x, w, mean, scale, y, part_weights, part_mean, part_scale);
    choice.error += fit_line(part_coding(fields, part), y, part_weights, part_mean, part_scale, choice.values[part]);
  }
  return choice;
}

inline void take_choice(const ints allowed, const Choice from, Choice* to) {
  const ints where = allowed && from.error < to->error;
  to->error = where ? from.error : to->error;
  to->way = where ? from.way : to->way;
  for (int part = 0; part < 3; ++part) {
#pragma unroll
    for (int k = 0; k < DIMS; ++k) {
      to->values[part][0][k] = where ? from.values[part][0][k] : to->values[part][0][k];
      to->values[part][1][k] = where ? from.values[part][1][k] : to->values[part][1][k];
    }
  }
}

kernel void bc7_encode(const Layout layout, global const int2* restrict tiles, global const TEXEL* restrict texels,
                       global const float* restrict weights, const float4 channel_weights,
                       global uint4* restrict blocks, global float* restrict decoded) {
  const ulong first = (ulong)get_global_id(0) * LANES;
  if (first >= layout.blocks) return;
  floats x[16 * DIMS], w[16], mean[DIMS], scale[DIMS];
  load_centred(layout, tiles, texels, weights, channel_weights, first, x, w, mean, scale);
  // What opaque modes cost a block that is not.
  floats opaque_error = 0.0f;
#if DIMS == 4
  for (int t = 0; t < 16; ++t) {
    const floats rest = TEXEL_OF(x, 3, t) + mean[3] - 255.0f;
    opaque_error += w[t] * scale[3] * rest * rest;
  }
#endif
  Candidates candidates;
  find_candidates(x, w, scale, opaque_error, &candidates);
  Choice best = code_way((ints)(6 * 64), x, w, mean, scale, opaque_error);
  for (int k = 0; k < KEPT; ++k) {
    // Lanes that would pass a way over do so also where others try it: no block depends on those beside it.
    const ints promising = candidates.cost[k] * DOUBT < best.error;
    if (!ANY(promising)) continue;
    take_choice(promising, code_way(candidates.way[k], x, w, mean, scale, opaque_error), &best);
  }

  const Fields fields = fields_of(best.way);
  ints index[16], second[16];
  floats result[16 * DIMS];
  uints words[4];
  find_indices(best, fields, x, w, mean, scale, index, second, result);
#ifdef DECODED
  store_texels(layout, tiles, result, first, decoded);
#endif
  pack(best, fields, index, second, words);
  for (int l = 0; l < LANES; ++l) {
    if (first + l >= layout.blocks) continue;
    const Place place = place_of(layout, tiles, first + l);
    if (!is_inside(layout, place)) continue;
    blocks[(ulong)place.y * layout.blocks_x + place.x] =
        (uint4)(LANE(uint, words[0], l), LANE(uint, words[1], l), LANE(uint, words[2], l), LANE(uint, words[3], l));
  }
}
