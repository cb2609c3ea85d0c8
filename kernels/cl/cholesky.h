// cholesky.h - C x C systems by Cholesky, one in every lane, or one matrix for the right-hand sides of all lanes.
#ifndef FACEZIP_CHOLESKY_H
#define FACEZIP_CHOLESKY_H

#include "grid_weights.h"
#include "lanes.h"

// A number of the matrix: floats where every lane has its own, float where they share one.
#ifndef MATRIX_T
#define MATRIX_T floats
#endif

// Makes L, with 1 / its diagonal there, of a + ridge.
inline void factor(MATRIX_T a[PAIRS], const float ridge) {
#pragma unroll
  for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
    for (int j = 0; j <= i; ++j) {
      MATRIX_T value = a[LOWER(i, j)];
      if (i == j) value += ridge;
#pragma unroll
      for (int k = 0; k < j; ++k) value -= a[LOWER(i, k)] * a[LOWER(j, k)];
      // Rounding may leave a pivot below what was added to it; it never is.
      a[LOWER(i, j)] = i == j ? 1.0f / sqrt(fmax(value, (MATRIX_T)(ridge))) : value * a[LOWER(j, j)];
    }
  }
}

// x becomes L^-1 x.
inline void substitute_forward(const MATRIX_T l[PAIRS], floats x[TEXTURES]) {
#pragma unroll
  for (int i = 0; i < TEXTURES; ++i) {
#pragma unroll
    for (int j = 0; j < i; ++j) x[i] -= l[LOWER(i, j)] * x[j];
    x[i] *= l[LOWER(i, i)];
  }
}

// Entry i of L^-T x, where those behind it stand already.
inline floats substitute_back(const MATRIX_T l[PAIRS], const floats x[TEXTURES], const int i) {
  floats value = x[i];
#pragma unroll
  for (int j = i + 1; j < TEXTURES; ++j) value -= l[LOWER(j, i)] * x[j];
  return value * l[LOWER(i, i)];
}

#endif
