// tiles.h - the tiles that the texels of a band are cut into.
// A tile is 16 x 16 texels, texel t = 16 * row + column inside it. Layout of every texel-sized buffer:
//   tiles          [tile] int2                           column of tiles in the image, row of tiles in the band
//   texel_weights  [tile][256] float                     what a texel weighs in every sum, 0 outside the covered texels
//   differences    [tile][expression][channel][256]      DIFF_T, in units of 1/255 of full scale
//   masks          [mask_begin[tile] .. mask_begin[tile + 1]][256]   float, 0..1
#ifndef FACEZIP_TILES_H
#define FACEZIP_TILES_H

#include "common.h"

#define TILE_SIDE FACEZIP_TILE_SIDE
#define TILE_TEXELS FACEZIP_TILE_TEXELS

// 1 to 4.
#ifndef CHANNELS
#define CHANNELS 3
#endif
// short for samples of 8 bits, whose differences are exact in it; float for all others.
#ifndef DIFF_T
#define DIFF_T short
#endif

#endif
