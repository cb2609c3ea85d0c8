// layout.h - sizes that kernels and host must agree on, in one place; C that both compile.
#ifndef FACEZIP_LAYOUT_H
#define FACEZIP_LAYOUT_H

// Numbers that lie side by side in every padded array: one AVX-512 register of floats, which is one line of most caches
// and half a warp of coalesced loads. Kernels for CPUs compute on float16.
#define FACEZIP_VECTOR 16

// The tiles that the texels of a band are cut into: a row is a vector.
#define FACEZIP_TILE_SIDE FACEZIP_VECTOR
#define FACEZIP_TILE_TEXELS (FACEZIP_TILE_SIDE * FACEZIP_TILE_SIDE)
// The tiles of the run time (blend.cl) are half as high: what a work-item blends then stays in the first-level cache.
#define FACEZIP_BLEND_TILE_ROWS 8
// What codes of the run time are widened by on their way to floats: 0x4700 in front of a byte c makes 32768 + c.
#define FACEZIP_CODE_BIAS 32768.0f

// Gram matrices are summed in blocks of 4 x 4 expressions (gram.cl): 16 products fill a vector.
#define FACEZIP_GRAM_BLOCK 4

// Work-items of difference_texture_clear take so many texels.
#define FACEZIP_CLEARED_TEXELS 64

// Work-items of weight_map.cl take so many cells.
#define FACEZIP_WEIGHT_MAP_CELLS 16

// Cells that 16 texels in a row interpolate between at most, with `scale` texels to a cell.
#define FACEZIP_CELLS_OF_16(scale) ((14 + (scale)) / (scale) + 2)

// The normal equations of the weights, for C textures. A symmetric C x C matrix has so many numbers:
#define FACEZIP_PAIRS(textures) ((textures) * ((textures) + 1) / 2)
#define FACEZIP_PADDED(count) (((count) + FACEZIP_VECTOR - 1) / FACEZIP_VECTOR * FACEZIP_VECTOR)
// Of a cell: four matrices (weight_system.cl), padded, before the right-hand sides.
#define FACEZIP_CELL_MATRICES(textures) FACEZIP_PADDED(4 * FACEZIP_PAIRS(textures))
// Of a half cell: one matrix (half_cell_fit.cl), padded, before the right-hand sides.
#define FACEZIP_HALF_CELL_MATRIX(textures) FACEZIP_PADDED(FACEZIP_PAIRS(textures))

// Numbers of a texel's factored system of difference textures (difference_factors.h).
#define FACEZIP_FACTOR_PLANES(textures, channels) (FACEZIP_PAIRS(textures) + (textures) * (channels) + 1)

#endif
