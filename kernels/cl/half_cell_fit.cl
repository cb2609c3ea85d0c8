// half_cell_fit.cl - what the weights' equations need of difference textures that suit the present weights, without them
// With w the weights at the centre of a half cell and G its Gram matrix (half_cell_gram.cl), the textures
// D(p) = (w w^T + ridge)^-1 w Delta(p) of its texels (difference_fit.cl) enter the equations of the weights
// (weight_system.cl) as two sums over the texels only:
//   S = sum_p t D Delta^T = Q G,   B = sum_p t D D^T = Q G Q^T,   Q = A^-1 w,   A = w w^T + ridge
// In this order rounding leaves B positive where weights hardly use a texture: A^-1 (w G w^T) A^-1 would magnify it by the
// square of 1 / ridge.
//
// NDRange  global {groups, half rows}, local {1, 1}: one work-item per 16 half cells side by side, one in each lane
// Buffers  grams    in   as half_cell_gram.cl writes it
//          weights  in   [row][column][C][lanes] float   W_n of the cell rows from first_cell_row on, n innermost
//          halves   out  [half row][half column][HALF_ENTRIES] float   B, C (C + 1) / 2 rounded up to 16; then S, [C][lanes]
//          errors   out  [half row][group] float   sum_p t |Delta - D^T w|^2 over the group
// Defines  TEXTURES, EXPRESSIONS, EXPRESSION_LANES  grid_weights.h
// Sums     fixed order: expressions

#include "cholesky.h"

#define GRAM(n, m) grams[(m) * ((m) + 1) / 2 + (n)]  // n <= m

// Rows become lanes: four times, the first half of the rows is woven with the second.
static void transpose(float16 rows[16]) {
#pragma unroll
  for (int stage = 0; stage < 4; ++stage) {
    float16 woven[16];
#pragma unroll
    for (int k = 0; k < 8; ++k) {
      const float16 a = rows[k];
      const float16 b = rows[k + 8];
      woven[2 * k].even = a.lo;
      woven[2 * k].odd = b.lo;
      woven[2 * k + 1].even = a.hi;
      woven[2 * k + 1].odd = b.hi;
    }
#pragma unroll
    for (int k = 0; k < 16; ++k) rows[k] = woven[k];
  }
}

// Weights of 16 half cells, a quarter of a cell from the centre of their own cell towards the next: [C][N], lane by lane.
static void interpolate(global const float16* restrict own_row, global const float16* restrict next_row,
                        const int first_half, const int columns, float16 weights[TEXTURES * EXPRESSION_LANES]) {
  const int vectors = TEXTURES * EXPRESSION_LANES / 16;
  for (int v = 0; v < vectors; ++v) {
    float16 values[16];
#pragma unroll
    for (int lane = 0; lane < 16; ++lane) {
      const int half_column = first_half + lane;
      const int own = min(half_column / 2, columns - 1);
      const int next = clamp(own + (half_column % 2 ? 1 : -1), 0, columns - 1);
      values[lane] = 0.5625f * own_row[own * vectors + v] + 0.0625f * next_row[next * vectors + v] +
                     0.1875f * (own_row[next * vectors + v] + next_row[own * vectors + v]);
    }
    transpose(values);
#pragma unroll
    for (int k = 0; k < 16; ++k) weights[v * 16 + k] = values[k];
  }
}

// q G of expression m.
static void multiply(global const float16* restrict grams, const float16 q[EXPRESSIONS][TEXTURES], const int m,
                     float16 product[TEXTURES]) {
#pragma unroll
  for (int i = 0; i < TEXTURES; ++i) product[i] = 0.0f;
  for (int n = 0; n < m; ++n) {
    const float16 g = GRAM(n, m);
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) product[i] = FMA(q[n][i], g, product[i]);
  }
  for (int n = m; n < EXPRESSIONS; ++n) {
    const float16 g = GRAM(m, n);
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) product[i] = FMA(q[n][i], g, product[i]);
  }
}

kernel __attribute__((reqd_work_group_size(1, 1, 1))) void half_cell_fit(
    global const float16* restrict grams, global const float16* restrict weights, global float16* restrict halves,
    global float* restrict errors, const int first_half_row, const int first_cell_row, const int cell_columns,
    const int cell_rows, const float ridge) {
  const int group = (int)get_global_id(0);
  const int groups = (int)get_global_size(0);
  const int half_row = (int)get_global_id(1);
  const ulong item = (ulong)half_row * groups + group;
  grams += item * (EXPRESSIONS * (EXPRESSIONS + 1) / 2);
  halves += item * (ulong)HALF_ENTRIES;

  float16 trace = 0.0f;
  for (int n = 0; n < EXPRESSIONS; ++n) trace += GRAM(n, n);
  if (sum_of_16(trace) == 0.0f) {  // no covered texel that ever changes
    for (int e = 0; e < HALF_ENTRIES; ++e) halves[e] = 0.0f;
    errors[item] = 0.0f;
    return;
  }

  float16 w[TEXTURES * EXPRESSION_LANES];
  const int own_row = (first_half_row + half_row) / 2;
  const int next_row = clamp(own_row + ((first_half_row + half_row) % 2 ? 1 : -1), 0, cell_rows - 1);
  const ulong row_vectors = (ulong)cell_columns * (TEXTURES * EXPRESSION_LANES / 16);
  interpolate(weights + (own_row - first_cell_row) * row_vectors, weights + (next_row - first_cell_row) * row_vectors,
              group * 16, cell_columns, w);

  float16 a[PAIRS];
  float16 l[PAIRS];
#pragma unroll
  for (int p = 0; p < PAIRS; ++p) a[p] = 0.0f;
  for (int n = 0; n < EXPRESSIONS; ++n) {
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
      for (int j = 0; j <= i; ++j) {
        a[LOWER(i, j)] = FMA(w[i * EXPRESSION_LANES + n], w[j * EXPRESSION_LANES + n], a[LOWER(i, j)]);
      }
    }
  }
#pragma unroll
  for (int p = 0; p < PAIRS; ++p) l[p] = a[p];
  factor(l, ridge);

  float16 q[EXPRESSIONS][TEXTURES];
  for (int n = 0; n < EXPRESSIONS; ++n) {
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) q[n][i] = w[i * EXPRESSION_LANES + n];
    substitute_forward(l, q[n]);
#pragma unroll
    for (int i = TEXTURES - 1; i >= 0; --i) q[n][i] = substitute_back(l, q[n], i);
  }

  // Entry e of lane k is results[e][k].
  float16 results[HALF_ENTRIES];
  for (int e = 0; e < HALF_ENTRIES; ++e) results[e] = 0.0f;
  float16 error = trace;
  for (int m = 0; m < EXPRESSIONS; ++m) {
    float16 x[TEXTURES];
    multiply(grams, q, m, x);
#pragma unroll
    for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
      for (int j = 0; j <= i; ++j) results[LOWER(i, j)] = FMA(x[i], q[m][j], results[LOWER(i, j)]);
      results[SIDES_BEGIN + i * EXPRESSION_LANES + m] = x[i];
      error -= 2.0f * x[i] * w[i * EXPRESSION_LANES + m];
    }
  }
#pragma unroll
  for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
    for (int j = 0; j <= i; ++j) error += (i == j ? 1.0f : 2.0f) * results[LOWER(i, j)] * a[LOWER(i, j)];
  }
  for (int v = 0; v < HALF_ENTRIES / 16; ++v) {
    float16 entries[16];
#pragma unroll
    for (int k = 0; k < 16; ++k) entries[k] = results[v * 16 + k];
    transpose(entries);
#pragma unroll
    for (int lane = 0; lane < 16; ++lane) halves[lane * (HALF_ENTRIES / 16) + v] = entries[lane];
  }
  errors[item] = sum_of_16(fmax(error, (float16)(0.0f)));
}
