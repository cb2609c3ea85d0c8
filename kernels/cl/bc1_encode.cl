// bc1_encode.cl - BC1 blocks from texels: two colours of 5, 6 and 5 bits, and two bits a texel for a step between them. Of
// 4-colour blocks and 3-colour blocks (never with transparent texels) the better one.
//   minimises sum over texels t and channels c of weight_t * channel_weight_c * (texel - decoded)^2
// Decoded are (2 a + b) / 3 and (a + b) / 2 of colours widened to 8 bits by repeating their upper ones, rounded; GPUs differ
// from that, and among each other, by a unit or so.
// NDRange  global {blocks to visit / LANES or more}, local any; blocks as block_texels.h counts them
// Buffers  tiles     in   [tile] int2     with TILES: column and row of tiles; else not read
//          texels    in   TEXEL           laid out as `layout` says, code units 0 to 255
//          weights   in   float           with TEXEL_WEIGHTS: of texels, not below 0; else not read
//          blocks    out  [row][column] uint2   blocks_y rows of blocks_x
//          decoded   out  float           with DECODED: laid out like texels; else not written
// Defines  block_texels.h's, CHANNELS 1 to 3
//          ROUNDS    times that colours are fitted to indices and indices to colours
//          SWEEPS    times that colours are moved by a step of their code
//          DECODED   if set, decoded texels are written

#define DIMS 3
#include "block_texels.h"
#include "block_line.h"

#ifndef ROUNDS
#define ROUNDS 2
#endif
#ifndef SWEEPS
#define SWEEPS 1
#endif
#define MOVES (SWEEPS * 8 * DIMS)

// The colour value that can be coded next to `value`.
inline floats codeable(const floats value, const int channel) {
  const float top = channel == 1 ? 63.0f : 31.0f;
  const float widen = channel == 1 ? 4.0f : 8.0f;
  const float fold = channel == 1 ? 1.0f / 16.0f : 1.0f / 4.0f;
  const floats code = min(max(NEAREST(value * (top / 255.0f)), (floats)(0.0f)), (floats)(top));
  return code * widen + NEAREST(code * fold - 0.49f);
}

inline floats nearest_index(const float levels, const Steps steps, const floats* x, const int t) {
  floats at = steps.offset;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) at += steps.along[k] * TEXEL_OF(x, k, t);
  return min(max(NEAREST(at), (floats)(0.0f)), (floats)(levels));
}

inline StepSums assign(const float levels, const floats* x, const floats* w, const floats scale[DIMS],
                       const floats ends[2][DIMS]) {
  const Steps steps = steps_of(levels, 0.0f, scale, ends);
  StepSums sums;
  sums.s = sums.ss = sums.error = 0.0f;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) sums.sx[k] = 0.0f;
  for (int t = 0; t < 16; ++t) {
    const floats step = nearest_index(levels, steps, x, t) * (1.0f / levels);
    const floats weighted = w[t] * step;
    sums.s += weighted;
    sums.ss += weighted * step;
#pragma unroll
    for (int k = 0; k < DIMS; ++k) {
      const floats texel = TEXEL_OF(x, k, t);
      sums.sx[k] += weighted * texel;
      const floats rest = texel - NEAREST(step * steps.span[k] + steps.start[k]);
      sums.error += w[t] * scale[k] * rest * rest;
    }
  }
  return sums;
}

typedef struct {
  floats error;
  floats ends[2][DIMS];  // less the mean
} Line;

inline void take_line(const Line from, Line* to) {
  const ints where = from.error < to->error;
  to->error = where ? from.error : to->error;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    to->ends[0][k] = where ? from.ends[0][k] : to->ends[0][k];
    to->ends[1][k] = where ? from.ends[1][k] : to->ends[1][k];
  }
}

// The first end makes up for the rounding of the second (Babai's nearest plane).
inline void fit_ends(const StepSums steps, const TexelSums sums, const floats mean[DIMS], floats ends[2][DIMS]) {
  const EndSystem system = solve_ends(steps, sums);
  const floats share = system.b / max(system.a, (floats)(1e-6f));
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    ends[1][k] = codeable(system.ideal[1][k] + mean[k], k) - mean[k];
    const floats moved = ends[1][k] - system.ideal[1][k];
    ends[0][k] = codeable(system.ideal[0][k] - share * moved + mean[k], k) - mean[k];
  }
}

// Moves one channel of one end, or of both, by a step of the code, where that helps.
inline void sweep_ends(const float levels, const floats* x, const floats* w, const floats mean[DIMS],
                       const floats scale[DIMS], Line* line) {
  for (int move = 0; move < MOVES; ++move) {
    const int k = move % DIMS;
    const int kind = move / DIMS % 8;
    // First end, second end, both alike, both against each other; each down and up.
    const float by = (kind & 1 ? 1.0f : -1.0f) * (k == 1 ? 255.0f / 63.0f : 255.0f / 31.0f);
    const float first = kind < 2 || kind > 3 ? by : 0.0f;
    const float second = kind < 2 ? 0.0f : kind > 5 ? -by : by;
    Line trial = *line;
    trial.ends[0][k] = codeable(trial.ends[0][k] + mean[k] + first, k) - mean[k];
    trial.ends[1][k] = codeable(trial.ends[1][k] + mean[k] + second, k) - mean[k];
    trial.error = assign(levels, x, w, scale, trial.ends).error;
    take_line(trial, line);
  }
}

inline Line fit_line(const float levels, const floats* x, const floats* w, const floats mean[DIMS],
                     const floats scale[DIMS], const TexelSums sums, const floats first[2][DIMS]) {
  Line best;
  best.error = LARGEST;
  Line line;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    line.ends[0][k] = best.ends[0][k] = first[0][k];
    line.ends[1][k] = best.ends[1][k] = first[1][k];
  }
  StepSums steps = assign(levels, x, w, scale, line.ends);
  for (int round = 0; round < ROUNDS; ++round) {
    fit_ends(steps, sums, mean, line.ends);
    steps = assign(levels, x, w, scale, line.ends);
    line.error = steps.error;
    take_line(line, &best);
  }
  sweep_ends(levels, x, w, mean, scale, &best);
  return best;
}

// 5, 6 and 5 bits of an end.
inline uints word_of(const floats end[DIMS], const floats mean[DIMS]) {
  const ints red = TO_INTS(end[0] + mean[0]) >> 3;
  const ints green = TO_INTS(end[1] + mean[1]) >> 2;
  const ints blue = TO_INTS(end[2] + mean[2]) >> 3;
  return AS_UINTS(red << 11 | green << 5 | blue);
}

kernel void bc1_encode(const Layout layout, global const int2* restrict tiles, global const TEXEL* restrict texels,
                       global const float* restrict weights, const float4 channel_weights,
                       global uint2* restrict blocks, global float* restrict decoded) {
  const ulong first = (ulong)get_global_id(0) * LANES;
  if (first >= layout.blocks) return;
  floats x[16 * DIMS], w[16], mean[DIMS], scale[DIMS];
  load_centred(layout, tiles, texels, weights, channel_weights, first, x, w, mean, scale);
  const TexelSums sums = sum_texels(x, w);
  floats ends[2][DIMS];
  first_ends(x, w, scale, sums, ends);
  const Line four = fit_line(3.0f, x, w, mean, scale, sums, ends);
  const Line three = fit_line(2.0f, x, w, mean, scale, sums, ends);
  const ints in_three = three.error < four.error;
  Line line = four;
  take_line(three, &line);

  const uints word0 = word_of(line.ends[0], mean);
  const uints word1 = word_of(line.ends[1], mean);
  // Four colours have the larger word first, three colours the smaller one.
  const ints swap = in_three ? word0 > word1 : word0 < word1;
  const Steps steps3 = steps_of(3.0f, 0.0f, scale, line.ends);
  const Steps steps2 = steps_of(2.0f, 0.0f, scale, line.ends);
  uints indices = 0u;
  for (int t = 0; t < 16; ++t) {
    const ints of_four = TO_INTS(nearest_index(3.0f, steps3, x, t));
    const ints of_three = TO_INTS(nearest_index(2.0f, steps2, x, t));
    const ints last = in_three ? (ints)(2) : (ints)(3);
    const ints index = in_three ? of_three : of_four;
    const floats step = TO_FLOATS(index) / TO_FLOATS(last);
    const ints along = swap ? last - index : index;
    // The ends are codes 0 and 1.
    const ints code = along == 0 ? (ints)(0) : along == last ? (ints)(1) : along + 1;
    indices |= AS_UINTS(code) << (uint)(2 * t);
#ifdef DECODED
#pragma unroll
    for (int k = 0; k < DIMS; ++k) {
      TEXEL_OF(x, k, t) = NEAREST(step * steps3.span[k] + steps3.start[k]) + mean[k];
    }
#endif
  }
#ifdef DECODED
  store_texels(layout, tiles, x, first, decoded);
#endif
  const uints words = (swap ? word1 : word0) | (swap ? word0 : word1) << 16u;
  for (int l = 0; l < LANES; ++l) {
    if (first + l >= layout.blocks) continue;
    const Place place = place_of(layout, tiles, first + l);
    if (!is_inside(layout, place)) continue;
    blocks[(ulong)place.y * layout.blocks_x + place.x] = (uint2)(LANE(uint, words, l), LANE(uint, indices, l));
  }
}
