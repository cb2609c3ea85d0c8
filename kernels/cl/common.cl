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

// Type names from macros: JOIN(float, WIDTH).
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

// Halves added to halves: one order on every device.
inline float sum_of_16(const float16 value) {
  const float8 half8 = value.lo + value.hi;
  const float4 half4 = half8.lo + half8.hi;
  const float2 half2 = half4.lo + half4.hi;
  return half2.x + half2.y;
}

#ifdef EXPRESSION_LANES
// As many texels, half cells or expressions as a work-item has at once.
#if defined(LANES) && LANES == 1
typedef float floats;
#else
typedef float16 floats;
#endif

// A symmetric C x C matrix, and the numbers of a cell in the normal equations of the weights (weight_system.cl): four
// blocks, rounded up to 16, then the right-hand sides.
#define PAIRS (TEXTURES * (TEXTURES + 1) / 2)
#define BLOCKS_END ((4 * PAIRS + 15) / 16 * 16)
#define ENTRIES (BLOCKS_END + TEXTURES * EXPRESSION_LANES)
// The same of a half cell (half_cell_fit.cl): one block, then the right-hand sides.
#define SIDES_BEGIN ((PAIRS + 15) / 16 * 16)
#define HALF_ENTRIES (SIDES_BEGIN + TEXTURES * EXPRESSION_LANES)

// C x C systems in every lane, by Cholesky. factor() makes L, with 1 / its diagonal there, of a + ridge.
#define LOWER(i, j) ((i) * ((i) + 1) / 2 + (j))  // j <= i

inline void factor(floats a[PAIRS], const float ridge) {
#pragma unroll
  for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
    for (int j = 0; j <= i; ++j) {
      floats value = a[LOWER(i, j)];
      if (i == j) value += ridge;
#pragma unroll
      for (int k = 0; k < j; ++k) value -= a[LOWER(i, k)] * a[LOWER(j, k)];
      // Rounding may leave a pivot below what was added to it; it never is.
      a[LOWER(i, j)] = i == j ? 1.0f / sqrt(fmax(value, (floats)(ridge))) : value * a[LOWER(j, j)];
    }
  }
}

// x becomes L^-1 x.
inline void substitute_forward(const floats l[PAIRS], floats x[TEXTURES]) {
#pragma unroll
  for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
    for (int j = 0; j < i; ++j) x[i] -= l[LOWER(i, j)] * x[j];
    x[i] *= l[LOWER(i, i)];
  }
}

// Entry i of L^-T x, where those behind it stand already.
inline floats substitute_back(const floats l[PAIRS], const floats x[TEXTURES], const int i) {
  floats value = x[i];
#pragma unroll
  for (int j = i + 1; j < TEXTURES; ++j) value -= l[LOWER(j, i)] * x[j];
  return value * l[LOWER(i, i)];
}
#endif

#ifdef WEIGHT_SCALE
// The weight grid, at 1 / WEIGHT_SCALE of the texture: cell q has its centre at texel (q + 1/2) WEIGHT_SCALE - 1/2, and a
// texel interpolates linearly between the centres around it; beyond the outer centres the edge repeats. Positions are
// clamped before they are split, so that the weights of the (at most) two cells along an axis always sum to 1. They are
// counted in whole steps of 1 / (2 WEIGHT_SCALE): rounding must not put a texel before a centre that it lies on, where
// the host holds no cell.
#define STEPS_OF_CELL (2 * WEIGHT_SCALE)

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

// Cells that 16 texels in a row interpolate between, at most.
#define CELLS_OF_16 ((14 + WEIGHT_SCALE) / WEIGHT_SCALE + 2)
#endif
