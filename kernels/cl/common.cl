// common.cl - what every kernel file may use; the host puts this text in front of each of them.
//
// Tile layout, used by every texel-sized buffer: a tile is 16 x 16 texels, texel t = 16 * row + column inside it.
//   differences  [tile][expression][channel][256]    DIFF_T, in units of 1/255 of full scale
//   masks        [tile_mask_begin[tile] .. tile_mask_begin[tile + 1]][256]   float, 0..1
// A row of 16 texels is one float16, which is one AVX-512 register and one half-warp of coalesced loads.

#ifndef TILE_SIDE
#define TILE_SIDE 16
#endif
#define TILE_TEXELS (TILE_SIDE * TILE_SIDE)

// A multiply-add that becomes one instruction where the device has one. fma() would be tens of times slower where it has
// none, and mad() stays two instructions on PoCL.
#pragma OPENCL FP_CONTRACT ON
#define FMA(a, b, c) ((a) * (b) + (c))

#ifdef WEIGHT_SCALE
// The weight grid, at 1 / WEIGHT_SCALE of the texture: cell q has its centre at texel (q + 1/2) WEIGHT_SCALE - 1/2, and a
// texel interpolates linearly between the centres around it; beyond the outer centres the edge repeats. Positions are
// clamped before they are split, so that the weights of the (at most) two cells along an axis always sum to 1.
inline float cell_position(int texel, int cells) {
  return clamp((float)(2 * texel + 1 - WEIGHT_SCALE) * (1.0f / (2 * WEIGHT_SCALE)), 0.0f, (float)(cells - 1));
}

// Cells that 16 texels in a row interpolate between, at most.
#define CELLS_OF_16 ((14 + WEIGHT_SCALE) / WEIGHT_SCALE + 2)
#endif
