// block_texels.h - blocks of 4 x 4 texels, LANES of them at once: the vectors, where texels lie, how they come and go.
// What encoders and decoders of blocks include. Texels are in code units, 0 to 255, and may lie between codes.
// Layouts  a picture: sample (x, y, c) at first + y * row_stride + x * texel_stride + c * channel_stride; a work-item has
//          LANES blocks that follow one another, in rows of blocks
//          TILES: tiles.h's tiles, sample (t, c) of one at first + tile * row_stride + c * channel_stride + t; a tile is
//          16 blocks, in rows of four
// Texels beyond width and rows repeat the last ones, and weigh nothing. Where no texel of a block has a weight, all have 1.
// Defines  LANES     blocks of a work-item: 16 on CPUs, 1 on GPUs
//          CHANNELS  samples of a texel, 1 to 4
//          TEXEL     type of a sample: float or uchar
//          TILES     if set, that layout
//          TEXEL_WEIGHTS  if set, texels have weights: [y][x] of the picture, [tile][256] of tiles
#ifndef FACEZIP_BLOCK_TEXELS_H
#define FACEZIP_BLOCK_TEXELS_H

#include "lanes.h"
#include "tiles.h"

#ifndef CHANNELS
#define CHANNELS 3
#endif
#ifndef TEXEL
#define TEXEL float
#endif

typedef VECTOR(int) ints;
typedef VECTOR(uint) uints;
#define TO_INTS JOIN(convert_, VECTOR(int))
#define AS_UINTS JOIN(as_, VECTOR(uint))
#if LANES == 1
#define ANY(condition) (condition)
#else
#define ANY(condition) any(condition)
#endif
// Lane l of a vector in private memory, to read or to write.
#define LANE(type, vector, l) (((type*)&(vector))[l])

#define TEXEL_OF(x, c, t) (x)[16 * (c) + (t)]
#define LARGEST 3.0e38f

// To the nearest whole number, below 2^22: one addition and its undoing. Halves go to even numbers.
#define NEAREST(value) ((value) + 12582912.0f - 12582912.0f)
// Added to multiples of 1/64 or thirds, it takes halves upwards, as decoders round.
#define HALF_UP (1.0f / 256.0f)

// A picture, or tiles of one, as kernels get it.
typedef struct {
  int width, rows;  // of the picture
  int blocks_x, blocks_y;
  ulong texel_stride, channel_stride;
  ulong row_stride;  // TILES: from tile to tile
  ulong first;
  ulong blocks;  // to visit, those outside included
} Layout;

// Where block `index` lies.
typedef struct {
  int x, y;      // column and row of blocks
  ulong sample;  // of its first texel, channel 0
  ulong weight;  // of its first texel
} Place;

inline Place place_of(const Layout layout, global const int2* tiles, const ulong index) {
  Place place;
#ifdef TILES
  const ulong tile = index / 16;
  const int block = (int)(index - 16 * tile);
  const int texel = block / 4 * (4 * TILE_SIDE) + (block & 3) * 4;
  place.x = tiles[tile].x * (TILE_SIDE / 4) + (block & 3);
  place.y = tiles[tile].y * (TILE_SIDE / 4) + block / 4;
  place.sample = layout.first + tile * layout.row_stride + texel;
  place.weight = tile * TILE_TEXELS + texel;
#else
  const ulong row = index / layout.blocks_x;
  place.y = (int)row;
  place.x = (int)(index - row * layout.blocks_x);
  place.sample = layout.first + (ulong)place.y * 4 * layout.row_stride + (ulong)place.x * 4 * layout.texel_stride;
  place.weight = (ulong)place.y * 4 * layout.width + (ulong)place.x * 4;
#endif
  return place;
}

// Whether the block is one of the picture's: the last work-item of a picture and tiles at its edges have others.
inline bool is_inside(const Layout layout, const Place place) { return place.x < layout.blocks_x && place.y < layout.blocks_y; }

// Offsets of texel (column, row) of a block.
inline ulong sample_offset(const Layout layout, const int column, const int row) {
#ifdef TILES
  return row * TILE_SIDE + column;
#else
  return row * layout.row_stride + column * layout.texel_stride;
#endif
}
inline ulong weight_offset(const Layout layout, const int column, const int row) {
#ifdef TILES
  return row * TILE_SIDE + column;
#else
  return (ulong)row * layout.width + column;
#endif
}

// Texels x and weights w of the blocks from `index` on.
inline void load_blocks(const Layout layout, global const int2* tiles, global const TEXEL* texels,
                        global const float* weights, const ulong index, floats* x, floats w[16]) {
  for (int l = 0; l < LANES; ++l) {
    const Place place = place_of(layout, tiles, min(index + l, layout.blocks - 1));
    // Of tiles at the edges whole blocks may lie outside; there is memory for them all the same.
    const int columns = clamp(layout.width - 4 * place.x, 1, 4);
    const int lines = clamp(layout.rows - 4 * place.y, 1, 4);
    float most = 0.0f;
    for (int t = 0; t < 16; ++t) {
      const int column = min(t & 3, columns - 1);
      const int row = min(t >> 2, lines - 1);
      const ulong at = place.sample + sample_offset(layout, column, row);
      for (int c = 0; c < CHANNELS; ++c) {
        LANE(float, TEXEL_OF(x, c, t), l) = (float)texels[at + c * layout.channel_stride];
      }
      float weight = (t & 3) < columns && (t >> 2) < lines ? 1.0f : 0.0f;
#ifdef TEXEL_WEIGHTS
      weight *= weights[place.weight + weight_offset(layout, column, row)];
#endif
      most = max(most, weight);
      LANE(float, w[t], l) = weight;
    }
    if (most == 0.0f) {
      for (int t = 0; t < 16; ++t) LANE(float, w[t], l) = (t & 3) < columns && (t >> 2) < lines ? 1.0f : 0.0f;
    }
  }
}

#ifdef DIMS
// Texels less their mean, which is rounded to whole numbers, and the weights of channels; channels that there are none of
// are 0 and weigh nothing.
inline void load_centred(const Layout layout, global const int2* tiles, global const TEXEL* texels,
                         global const float* weights, const float4 channel_weights, const ulong index, floats x[16 * DIMS],
                         floats w[16], floats mean[DIMS], floats scale[DIMS]) {
  const float channels[4] = {channel_weights.x, channel_weights.y, channel_weights.z, channel_weights.w};
  load_blocks(layout, tiles, texels, weights, index, x, w);
  floats n = 0.0f;
  for (int t = 0; t < 16; ++t) n += w[t];
  const floats per = 1.0f / max(n, (floats)(1e-6f));
#pragma unroll
  for (int c = 0; c < DIMS; ++c) {
    scale[c] = c < CHANNELS ? channels[c] : 0.0f;
    floats sum = 0.0f;
    for (int t = 0; t < 16; ++t) {
      if (c >= CHANNELS) TEXEL_OF(x, c, t) = 0.0f;
      sum += w[t] * TEXEL_OF(x, c, t);
    }
    mean[c] = NEAREST(min(max(sum * per, (floats)(0.0f)), (floats)(255.0f)));
    for (int t = 0; t < 16; ++t) TEXEL_OF(x, c, t) -= mean[c];
  }
}
#endif

// The same of decoded texels, as floats; texels beyond the edges are left out.
inline void store_texels(const Layout layout, global const int2* tiles, const floats x[16 * CHANNELS],
                         const ulong index, global float* texels) {
  for (int l = 0; l < LANES; ++l) {
    if (index + l >= layout.blocks) continue;
    const Place place = place_of(layout, tiles, index + l);
    if (!is_inside(layout, place)) continue;
    const int columns = min(layout.width - 4 * place.x, 4);
    const int lines = min(layout.rows - 4 * place.y, 4);
    for (int t = 0; t < 16; ++t) {
      if ((t & 3) >= columns || (t >> 2) >= lines) continue;
      const ulong at = place.sample + sample_offset(layout, t & 3, t >> 2);
      for (int c = 0; c < CHANNELS; ++c) {
        texels[at + c * layout.channel_stride] = LANE(float, TEXEL_OF(x, c, t), l);
      }
    }
  }
}

#endif
