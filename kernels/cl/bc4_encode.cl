// bc4_encode.cl - BC4 blocks, or with two channels BC5 blocks, from texels: for each channel two values of 8 bits and three
// bits a texel for a step between them. Blocks of 8 steps, or of 6 steps, 0 and 255, whichever is better.
//   minimises sum over texels t of weight_t * (texel - decoded)^2 in each channel
// Decoded are ((7 - i) a + i b) / 7 or ((5 - i) a + i b) / 5, not rounded: GPUs keep more than 8 bits.
// NDRange  global {blocks to visit / LANES or more}, local any; blocks as block_texels.h counts them
// Buffers  tiles     in   [tile] int2     with TILES: column and row of tiles; else not read
//          texels    in   TEXEL           laid out as `layout` says, code units 0 to 255
//          weights   in   float           with TEXEL_WEIGHTS: of texels, not below 0; else not read
//          blocks    out  [row][column][CHANNELS] uint2   blocks_y rows of blocks_x
//          decoded   out  float           with DECODED: laid out like texels; else not written
// Defines  block_texels.h's, CHANNELS 1 or 2
//          ROUNDS    times that ends are fitted to indices and indices to ends
//          SWEEPS    times that ends are moved by one
//          STARTS    ends to start from, 1 to 4
//          DECODED   if set, decoded texels are written

#ifndef CHANNELS
#define CHANNELS 1
#endif
#include "block_texels.h"

#ifndef ROUNDS
#define ROUNDS 2
#endif
#ifndef SWEEPS
#define SWEEPS 1
#endif
#ifndef STARTS
#define STARTS 1
#endif

typedef struct {
  floats error;
  floats low, high;  // whole numbers, low <= high
} Ends;

inline void take_ends(const Ends from, Ends* to) {
  const ints where = from.error < to->error;
  to->error = where ? from.error : to->error;
  to->low = where ? from.low : to->low;
  to->high = where ? from.high : to->high;
}

// Texels assigned to the steps between ends: sums of weight times step, its square and texel over those that take a step.
typedef struct {
  floats error;
  floats n, x, s, ss, sx;
} StepSums;

// The index of a texel, counted from the low end. With 5 levels 6 and 7 are 0 and 255.
inline ints nearest_index(const float levels, const floats low, const floats high, const floats x, floats* value) {
  const floats span = high - low;
  const floats per = span > 0.0f ? levels / max(span, (floats)(0.5f)) : (floats)(0.0f);
  const floats index = min(max(NEAREST((x - low) * per), (floats)(0.0f)), (floats)(levels));
  *value = low + index * (span * (1.0f / levels));
  ints found = TO_INTS(index);
  if (levels == 5.0f) {
    const floats error = fabs(x - *value);
    const ints is_low = x < error;
    const ints is_high = 255.0f - x < error;
    *value = is_low ? (floats)(0.0f) : is_high ? (floats)(255.0f) : *value;
    found = is_low ? (ints)(6) : is_high ? (ints)(7) : found;
  }
  return found;
}

inline StepSums assign(const float levels, const floats* x, const floats* w, const Ends ends) {
  StepSums sums;
  sums.error = sums.n = sums.x = sums.s = sums.ss = sums.sx = 0.0f;
  for (int t = 0; t < 16; ++t) {
    floats value;
    const ints index = nearest_index(levels, ends.low, ends.high, x[t], &value);
    const floats rest = x[t] - value;
    sums.error += w[t] * rest * rest;
    const floats own = index > TO_INTS((floats)(levels)) ? (floats)(0.0f) : w[t];
    const floats step = TO_FLOATS(index) * (1.0f / levels);
    sums.n += own;
    sums.x += own * x[t];
    sums.s += own * step;
    sums.ss += own * step * step;
    sums.sx += own * step * x[t];
  }
  return sums;
}

// The best ends for those steps, rounded one after the other: the low end makes up for the rounding of the high one.
inline void fit_ends(const StepSums sums, Ends* ends) {
  const floats a = sums.n - 2.0f * sums.s + sums.ss;
  const floats b = sums.s - sums.ss;
  const floats c = sums.ss;
  const floats determinant = a * c - b * b;
  const ints flat = determinant < 1e-4f * sums.n * sums.n || sums.n <= 0.0f;
  const floats inverse = 1.0f / (flat ? (floats)(1.0f) : determinant);
  const floats rest = sums.x - sums.sx;
  const floats low = (c * rest - b * sums.sx) * inverse;
  const floats high = (a * sums.sx - b * rest) * inverse;
  const floats rounded = min(max(NEAREST(high), (floats)(0.0f)), (floats)(255.0f));
  const floats other = low - b / max(a, (floats)(1e-6f)) * (rounded - high);
  ends->high = flat ? ends->high : rounded;
  ends->low = flat ? ends->low : min(max(NEAREST(other), (floats)(0.0f)), ends->high);
}

inline Ends fit_block(const float levels, const floats* x, const floats* w, const floats lowest, const floats highest) {
  Ends ends;
  ends.low = NEAREST(min(max(lowest, (floats)(0.0f)), (floats)(255.0f)));
  ends.high = NEAREST(min(max(highest, ends.low), (floats)(255.0f)));
  StepSums sums = assign(levels, x, w, ends);
  ends.error = sums.error;
  Ends best = ends;
  for (int round = 0; round < ROUNDS; ++round) {
    fit_ends(sums, &ends);
    sums = assign(levels, x, w, ends);
    ends.error = sums.error;
    take_ends(ends, &best);
  }
  for (int move = 0; move < 8 * SWEEPS; ++move) {
    // The low end, the high one, both, both against each other; each down and up.
    const int kind = move % 8;
    const float by = kind & 1 ? 1.0f : -1.0f;
    ends.low = min(max(best.low + (kind < 2 || kind > 3 ? by : 0.0f), (floats)(0.0f)), (floats)(255.0f));
    ends.high = best.high + (kind < 2 ? 0.0f : kind > 5 ? -by : by);
    ends.high = min(max(ends.high, ends.low), (floats)(255.0f));
    ends.error = assign(levels, x, w, ends).error;
    take_ends(ends, &best);
  }
  return best;
}

// Which code an index is, from the end that comes first.
inline ints code_of(const ints index, const ints last) {
  return index > last ? index : index == 0 ? (ints)(0) : index == last ? (ints)(1) : index + 1;
}

kernel void bc4_encode(const Layout layout, global const int2* restrict tiles, global const TEXEL* restrict texels,
                       global const float* restrict weights, const float4 channel_weights,
                       global uint2* restrict blocks, global float* restrict decoded) {
  const ulong first = (ulong)get_global_id(0) * LANES;
  if (first >= layout.blocks) return;
  floats all[16 * CHANNELS], w[16];
  load_blocks(layout, tiles, texels, weights, first, all, w);
  for (int c = 0; c < CHANNELS; ++c) {
    floats* x = all + 16 * c;
    floats lowest = LARGEST, highest = -LARGEST;
    for (int t = 0; t < 16; ++t) {
      lowest = w[t] > 0.0f ? min(lowest, x[t]) : lowest;
      highest = w[t] > 0.0f ? max(highest, x[t]) : highest;
    }
    // Ends outside the texels' and inside.
    Ends best = fit_block(7.0f, x, w, lowest, highest);
    for (int start = 1; start < STARTS; ++start) {
      const floats inset = (highest - lowest) * (start & 1 ? 0.07f : -0.04f) * (float)((start + 1) / 2);
      take_ends(fit_block(7.0f, x, w, lowest + inset, highest - inset), &best);
    }
    // Only blocks that reach 0 or 255 gain by having these for themselves.
    const ints reaches = lowest < 8.0f || highest > 247.0f;
    ints in_six = 0;
    if (ANY(reaches)) {
      for (int start = 0; start < STARTS; ++start) {
        // Texels nearer than that to 0 or 255 take these.
        const float near = start == 0 ? 8.0f : start == 1 ? 24.0f : start == 2 ? 48.0f : 2.0f;
        floats inner_lowest = LARGEST, inner_highest = -LARGEST;
        for (int t = 0; t < 16; ++t) {
          const ints inner = w[t] > 0.0f && x[t] > near && x[t] < 255.0f - near;
          inner_lowest = inner ? min(inner_lowest, x[t]) : inner_lowest;
          inner_highest = inner ? max(inner_highest, x[t]) : inner_highest;
        }
        Ends six = fit_block(5.0f, x, w, inner_lowest, inner_highest);
        six.error = reaches ? six.error : (floats)(LARGEST);
        in_six = six.error < best.error ? (ints)(-1) : in_six;
        take_ends(six, &best);
      }
    }
    // Equal ends would say 6 steps; all texels then have the first of them.
    uints bits[2];
    bits[0] = 0u;
    bits[1] = 0u;
    for (int t = 0; t < 16; ++t) {
      floats in_7, in_5;
      const ints of_7 = nearest_index(7.0f, best.low, best.high, x[t], &in_7);
      const ints of_5 = nearest_index(5.0f, best.low, best.high, x[t], &in_5);
      // With 8 steps the high end comes first.
      const uints code = AS_UINTS(in_six ? code_of(of_5, (ints)(5)) : best.low < best.high ? code_of(7 - of_7, (ints)(7)) : (ints)(0));
      x[t] = in_six ? in_5 : in_7;
      const int at = 16 + 3 * t;
      bits[at >> 5] |= code << (uint)(at & 31);
      if ((at & 31) > 29) bits[1] |= code >> (uint)(32 - (at & 31));
    }
    const uints low = AS_UINTS(TO_INTS(best.low));
    const uints high = AS_UINTS(TO_INTS(best.high));
    bits[0] |= in_six ? low | high << 8u : high | low << 8u;
    for (int l = 0; l < LANES; ++l) {
      const Place place = place_of(layout, tiles, first + l);
      if (!is_inside(layout, place)) continue;
      blocks[((ulong)place.y * layout.blocks_x + place.x) * CHANNELS + c] = (uint2)(LANE(uint, bits[0], l), LANE(uint, bits[1], l));
    }
  }
#ifdef DECODED
  store_texels(layout, tiles, all, first, decoded);
#endif
}
