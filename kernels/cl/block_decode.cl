// block_decode.cl - texels of BC1, BC4, BC5 or BC7 blocks, as encoders here report them: BC1 and BC7 whole numbers, BC4 and
// BC5 not rounded. Every pattern of bits decodes: BC1's transparent texels are black, as are BC7 blocks without a mode.
// NDRange  global {blocks to visit or more}, local any
// Buffers  tiles   in   [tile] int2   with TILES: column and row of tiles; else not read
//          blocks  in   [row][column] of 8 bytes (BC1, BC4) or 16   blocks_y rows of blocks_x
//          texels  out  TEXEL         laid out as `layout` says, code units 0 to 255; the first CHANNELS of the format's
// Defines  block_texels.h's, TEXEL float, or uchar with WHOLE: what is not whole is rounded, halves upwards
//          FORMAT  1, 4, 5 or 7

#define LANES 1
#include "block_texels.h"
#include "bc7_tables.h"

#ifndef FORMAT
#define FORMAT 7
#endif
#ifdef WHOLE
#define STORED(value) (uchar)((value) + 0.5f)
#else
#define STORED(value) (value)
#endif

// Bits of a block, from the lowest up.
typedef struct {
  ulong low, high;
} Bits;

inline uint take(Bits* bits, const uint count) {
  const uint value = (uint)bits->low & ((1u << count) - 1u);
  // Shifts by 64 are undefined: in two steps.
  bits->low = (bits->low >> count) | ((bits->high << 1) << (63u - count));
  bits->high >>= count;
  return value;
}

#if FORMAT == 1
inline void decode(const uint2 block, float texels[16][4]) {
  float colours[4][4];
  for (int end = 0; end < 2; ++end) {
    const uint word = block.x >> (16 * end) & 0xffffu;
    const uint red = word >> 11, green = word >> 5 & 63u, blue = word & 31u;
    colours[end][0] = (float)(red << 3 | red >> 2);
    colours[end][1] = (float)(green << 2 | green >> 4);
    colours[end][2] = (float)(blue << 3 | blue >> 2);
    colours[end][3] = 255.0f;
  }
  const bool four = (block.x & 0xffffu) > block.x >> 16;
  for (int c = 0; c < 4; ++c) {
    const float a = colours[0][c], b = colours[1][c];
    colours[2][c] = four ? floor((2.0f * a + b + 1.0f) / 3.0f) : floor((a + b + 1.0f) / 2.0f);
    colours[3][c] = four ? floor((a + 2.0f * b + 1.0f) / 3.0f) : 0.0f;
  }
  for (int t = 0; t < 16; ++t) {
    const uint code = block.y >> (2 * t) & 3u;
    for (int c = 0; c < 4; ++c) texels[t][c] = colours[code][c];
  }
}
#endif

#if FORMAT == 4 || FORMAT == 5
inline void decode_channel(const uint2 block, const int c, float texels[16][4]) {
  const float a = (float)(block.x & 255u), b = (float)(block.x >> 8 & 255u);
  const bool eight = a > b;
  Bits bits;
  bits.low = ((ulong)block.y << 32 | block.x) >> 16;
  bits.high = 0;
  for (int t = 0; t < 16; ++t) {
    const uint code = take(&bits, 3);
    const float levels = eight ? 7.0f : 5.0f;
    const float index = code == 0 ? 0.0f : code == 1 ? levels : (float)code - 1.0f;
    const float value = a + index * ((b - a) * (1.0f / levels));
    texels[t][c] = eight || code < 6 ? value : code == 6 ? 0.0f : 255.0f;
  }
}
#endif

#if FORMAT == 7
inline uint interpolate(const uint a, const uint b, const uint index, const uint bits) {
  // Weights of 64: 2, 3 and 4 bits have 3, 7 and 15 steps.
  const uint last = (1u << bits) - 1u;
  const uint weight = (index * 128u + last) / (2u * last);
  return ((64u - weight) * a + weight * b + 32u) >> 6;
}

inline void decode(const uint4 block, float texels[16][4]) {
  Bits bits;
  bits.low = (ulong)block.y << 32 | block.x;
  bits.high = (ulong)block.w << 32 | block.z;
  int mode = 0;
  while (mode < 8 && take(&bits, 1) == 0) ++mode;
  if (mode == 8) {
    for (int t = 0; t < 16; ++t) {
      for (int c = 0; c < 4; ++c) texels[t][c] = 0.0f;
    }
    return;
  }
  const int subsets = kSubsets[mode];
  const uint partition = take(&bits, kPartitionBits[mode]);
  const bool dual = kSecondIndexBits[mode] > 0;
  const uint rotation = dual ? take(&bits, 2) : 0;
  const uint selector = mode == 4 ? take(&bits, 1) : 0;
  uint ends[6][4];
  for (int c = 0; c < 4; ++c) {
    const uint count = c < 3 ? kColourBits[mode] : kAlphaBits[mode];
    for (int end = 0; end < 2 * subsets; ++end) ends[end][c] = take(&bits, count);
  }
  const int p_bits = kPBits[mode];
  for (int subset = 0; subset < subsets; ++subset) {
    const uint first = p_bits > 0 ? take(&bits, 1) : 0;
    const uint second = p_bits > 1 ? take(&bits, 1) : first;
    for (int c = 0; c < 4; ++c) {
      uint count = c < 3 ? kColourBits[mode] : kAlphaBits[mode];
      for (int side = 0; side < 2; ++side) {
        uint value = ends[2 * subset + side][c];
        uint used = count;
        if (p_bits > 0) {
          value = value << 1 | (side ? second : first);
          ++used;
        }
        value <<= 8 - used;
        ends[2 * subset + side][c] = count == 0 ? 255u : value | value >> used;
      }
    }
  }
  const uint anchors = subsets == 3 ? kThreeAnchors[partition] : kSecondAnchor[partition];
  uint first_index[16], second_index[16];
  const uint first_bits = kIndexBits[mode], second_bits = kSecondIndexBits[mode];
  for (int t = 0; t < 16; ++t) {
    const bool anchored = t == 0 || (subsets == 2 && t == anchors) || (subsets == 3 && (t == (anchors & 15) || t == anchors >> 4));
    first_index[t] = take(&bits, first_bits - (anchored ? 1 : 0));
  }
  for (int t = 0; t < 16; ++t) second_index[t] = dual ? take(&bits, second_bits - (t == 0 ? 1 : 0)) : 0;
  for (int t = 0; t < 16; ++t) {
    const uint subset = subsets == 1 ? 0 : subsets == 2 ? kTwoSubsets[partition] >> t & 1u : kThreeSubsets[partition] >> (2 * t) & 3u;
    uint value[4];
    for (int c = 0; c < 4; ++c) {
      // With two planes alpha has one, and the selector says which.
      const bool other = dual && (c == 3) == (selector == 0);
      value[c] = interpolate(ends[2 * subset][c], ends[2 * subset + 1][c], other ? second_index[t] : first_index[t],
                             other ? second_bits : first_bits);
    }
    for (int c = 0; c < 4; ++c) {
      const uint from = rotation == 0 ? c : c == 3 ? rotation - 1 : c == rotation - 1 ? 3 : c;
      texels[t][c] = (float)value[from];
    }
  }
}
#endif

kernel void block_decode(const Layout layout, global const int2* restrict tiles, global const uint2* restrict blocks,
                         global TEXEL* restrict texels) {
  if (get_global_id(0) >= layout.blocks) return;
  const Place place = place_of(layout, tiles, get_global_id(0));
  if (!is_inside(layout, place)) return;
  const ulong at = (ulong)place.y * layout.blocks_x + place.x;
  float decoded[16][4];
#if FORMAT == 1
  decode(blocks[at], decoded);
#elif FORMAT == 4
  decode_channel(blocks[at], 0, decoded);
#elif FORMAT == 5
  decode_channel(blocks[2 * at], 0, decoded);
  decode_channel(blocks[2 * at + 1], 1, decoded);
#else
  decode((uint4)(blocks[2 * at], blocks[2 * at + 1]), decoded);
#endif
  const int columns = min(layout.width - 4 * place.x, 4);
  const int lines = min(layout.rows - 4 * place.y, 4);
  for (int t = 0; t < 16; ++t) {
    if ((t & 3) >= columns || (t >> 2) >= lines) continue;
    const ulong sample = place.sample + sample_offset(layout, t & 3, t >> 2);
    for (int c = 0; c < CHANNELS; ++c) {
      texels[sample + c * layout.channel_stride] = STORED(decoded[t][c]);
    }
  }
}
