// difference_texture_encode.cl - difference textures as integer codes in rows, ready to be written as images
//   codes[i][y][x][c] = floor(clamp((D_i(y, x, c) - offset) / scale + 0.5, 0, CODE_MAX)),   value = scale * code + offset
// In 16 bits float arithmetic moves the quotient by up to 0.02 of a code: zero keeps its code, and a value near the
// middle between two may get either.
// Two kernels: difference_texture_clear writes the code of 0 everywhere, since tiles without work are not in the list;
// difference_texture_encode then writes the texels of the tiles, where D is 0 outside the masks.
//
// NDRange  clear:  global {roundUp(texels / 64, 16), textures}, local {16, 1}: one work-item per 64 texels
//          encode: global {16, textures, tiles}, local {16, 1, 1}: one work-item per row of 16 texels of a tile
// Buffers  tiles     in   [tile] int2   column and row of tiles in the band
//          textures  in   [tile][texture][CHANNELS][256] float, units of 1/255
//          encoding  in   [texture][CHANNELS] float2  (1 / scale or 0 where scale is 0, offset)
//          codes     out  [texture][rows][width][CHANNELS] CODE
// Defines  CHANNELS   tiles.h
//          CODE_BITS  8, CODE is uchar (8), or 16, ushort

#include "tiles.h"

#ifndef CODE_BITS
#define CODE_BITS 8
#endif

#if CODE_BITS == 16
#define CODE ushort
#define CODE_MAX 65535.0f
#else
#define CODE uchar
#define CODE_MAX 255.0f
#endif

static CODE encode(float value, float2 encoding) {
  return (CODE)clamp((value - encoding.y) * encoding.x + 0.5f, 0.0f, CODE_MAX);
}

kernel void difference_texture_clear(global const float2* encoding, global CODE* codes, ulong texels) {
  const ulong texture = get_global_id(1);
  const ulong begin = get_global_id(0) * FACEZIP_CLEARED_TEXELS;
  const ulong end = min(begin + FACEZIP_CLEARED_TEXELS, texels);
  CODE zero[CHANNELS];
  for (int c = 0; c < CHANNELS; ++c) zero[c] = encode(0.0f, encoding[texture * CHANNELS + c]);
  for (ulong texel = begin; texel < end; ++texel) {
    for (int c = 0; c < CHANNELS; ++c) codes[(texture * texels + texel) * CHANNELS + c] = zero[c];
  }
}

kernel void difference_texture_encode(global const int2* tiles, global const float* textures,
                                      global const float2* encoding, global CODE* codes, int width, int rows) {
  const int row = (int)get_global_id(0);
  const ulong texture = get_global_id(1);
  const ulong tile = get_global_id(2);
  const int x = tiles[tile].x * TILE_SIDE;
  const int y = tiles[tile].y * TILE_SIDE + row;
  if (y >= rows) return;
  const ulong plane = (tile * get_global_size(1) + texture) * CHANNELS;
  global CODE* out = codes + ((texture * (ulong)rows + (ulong)y) * (ulong)width + (ulong)x) * CHANNELS;
  for (int t = 0; t < min(TILE_SIDE, width - x); ++t) {
    for (int c = 0; c < CHANNELS; ++c) {
      const float value = textures[(plane + c) * TILE_TEXELS + row * TILE_SIDE + t];
      out[t * CHANNELS + c] = encode(value, encoding[texture * CHANNELS + c]);
    }
  }
}
