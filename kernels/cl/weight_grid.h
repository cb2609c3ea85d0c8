// weight_grid.h - where texels lie on the weight grid, at 1 / WEIGHT_SCALE of the texture.
// Cell q has its centre at texel (q + 1/2) WEIGHT_SCALE - 1/2, and a texel interpolates linearly between the centres
// around it; beyond the outer centres the edge repeats. Positions are clamped before they are split, so that the weights
// of the (at most) two cells along an axis always sum to 1. They are counted in whole steps of 1 / (2 WEIGHT_SCALE):
// rounding must not put a texel before a centre that it lies on, where the host holds no cell.
#ifndef FACEZIP_WEIGHT_GRID_H
#define FACEZIP_WEIGHT_GRID_H

#include "layout.h"

// Texels to a cell, along each axis.
#ifndef WEIGHT_SCALE
#define WEIGHT_SCALE 8
#endif

#define STEPS_OF_CELL (2 * WEIGHT_SCALE)
#define CELLS_OF_16 FACEZIP_CELLS_OF_16(WEIGHT_SCALE)

// The position of a texel in cells; its whole part is exact.
inline float cell_position(int texel, int cells) {
  const int steps = clamp(2 * texel + 1 - WEIGHT_SCALE, 0, STEPS_OF_CELL * (cells - 1));
  const int cell = steps / STEPS_OF_CELL;
  return (float)cell + (float)(steps - cell * STEPS_OF_CELL) * (1.0f / STEPS_OF_CELL);
}

// Those of 16 texels from `texel` on, counted from cell `first`. The bounds are vectors because Oclgrind misreads scalar
// ones beside a vector of int.
inline float16 cell_positions_of_16(int texel, int first, int cells) {
  const int16 column = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const int16 last = (int16)(STEPS_OF_CELL * (cells - 1));
  const int16 steps = clamp(2 * (texel + column) + (1 - WEIGHT_SCALE), (int16)0, last);
  return convert_float16(steps - first * STEPS_OF_CELL) * (1.0f / STEPS_OF_CELL);
}

#endif
