// grid_weights.h - weights of the grid while they are fitted, and the numbers of their normal equations.
//   weights   [row][column][TEXTURES][EXPRESSION_LANES] float     W_n of a cell, n innermost, 0 past N
//   system    [row][column][ENTRIES] float                        four matrices of a cell, then the right-hand sides
//   halves    [half row][half column][HALF_ENTRIES] float         one matrix of a half cell, then the right-hand sides
#ifndef FACEZIP_GRID_WEIGHTS_H
#define FACEZIP_GRID_WEIGHTS_H

#include "layout.h"

// C, 1 to 8.
#ifndef TEXTURES
#define TEXTURES 4
#endif
// N.
#ifndef EXPRESSIONS
#define EXPRESSIONS 20
#endif
// N, padded. Kernels that need no more of N take it alone, so that captures of 17 to 32 expressions share them.
#ifndef EXPRESSION_LANES
#define EXPRESSION_LANES FACEZIP_PADDED(EXPRESSIONS)
#endif

#define CELL_FLOATS (TEXTURES * EXPRESSION_LANES)
#define PAIRS FACEZIP_PAIRS(TEXTURES)
#define BLOCKS_END FACEZIP_CELL_MATRICES(TEXTURES)
#define ENTRIES (BLOCKS_END + CELL_FLOATS)
#define SIDES_BEGIN FACEZIP_HALF_CELL_MATRIX(TEXTURES)
#define HALF_ENTRIES (SIDES_BEGIN + CELL_FLOATS)
// Entry (i, j) of a symmetric matrix, j <= i.
#define LOWER(i, j) ((i) * ((i) + 1) / 2 + (j))

#endif
