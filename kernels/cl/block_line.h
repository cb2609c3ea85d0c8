// block_line.h - lines through the weighted colours of a block. What encoders of colours include, after block_texels.h.
// Texels are less the block's mean, a whole number, so that float sums keep their digits and decoding stays exact.
// Errors are squares, each channel's times its scale.
// Defines  DIMS  channels of a line: 3, or 4 with alpha
#ifndef FACEZIP_BLOCK_LINE_H
#define FACEZIP_BLOCK_LINE_H

#define PAIR(i, j) ((i) * ((i) + 1) / 2 + (j))  // of a symmetric matrix, j <= i
#define PAIR_OF(i, j) ((i) >= (j) ? PAIR(i, j) : PAIR(j, i))
#define PRODUCTS (DIMS * (DIMS + 1) / 2)

// Sums over texels: of weight, and of weight times texel and products of its channels.
typedef struct {
  floats n, x[DIMS], xx[PRODUCTS];
} TexelSums;

inline TexelSums sum_texels(const floats* x, const floats* w) {
  TexelSums sums;
  sums.n = 0.0f;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) sums.x[k] = 0.0f;
#pragma unroll
  for (int k = 0; k < PRODUCTS; ++k) sums.xx[k] = 0.0f;
  for (int t = 0; t < 16; ++t) {
    sums.n += w[t];
#pragma unroll
    for (int i = 0; i < DIMS; ++i) {
      const floats weighted = w[t] * TEXEL_OF(x, i, t);
      sums.x[i] += weighted;
#pragma unroll
      for (int j = 0; j <= i; ++j) sums.xx[PAIR(i, j)] += weighted * TEXEL_OF(x, j, t);
    }
  }
  return sums;
}

// The direction in which x varies most, by power iteration from the row of its most varied channel.
inline void principal_axis(const floats covariance[PRODUCTS], const floats scale[DIMS], floats axis[DIMS]) {
  floats largest = covariance[0] * scale[0];
#pragma unroll
  for (int i = 0; i < DIMS; ++i) axis[i] = covariance[PAIR(i, 0)];
#pragma unroll
  for (int row = 1; row < DIMS; ++row) {
    const floats variance = covariance[PAIR(row, row)] * scale[row];
    const ints more = variance > largest;
    largest = max(largest, variance);
#pragma unroll
    for (int i = 0; i < DIMS; ++i) axis[i] = more ? covariance[PAIR_OF(i, row)] : axis[i];
  }
  for (int round = 0; round < 4; ++round) {
    floats next[DIMS];
    floats size = 1e-12f;
#pragma unroll
    for (int i = 0; i < DIMS; ++i) {
      next[i] = 0.0f;
#pragma unroll
      for (int j = 0; j < DIMS; ++j) next[i] += covariance[PAIR_OF(i, j)] * scale[j] * axis[j];
      size = max(size, fabs(next[i]));
    }
    const floats per = 1.0f / size;
#pragma unroll
    for (int i = 0; i < DIMS; ++i) axis[i] = next[i] * per;
  }
}

// Ends of the texels on their principal axis.
inline void first_ends(const floats* x, const floats* w, const floats scale[DIMS], const TexelSums sums,
                       floats ends[2][DIMS]) {
  const floats per = 1.0f / max(sums.n, (floats)(1e-6f));
  floats covariance[PRODUCTS];
  floats centre[DIMS];
  floats axis[DIMS];
#pragma unroll
  for (int i = 0; i < DIMS; ++i) {
    centre[i] = sums.x[i] * per;
#pragma unroll
    for (int j = 0; j <= i; ++j) covariance[PAIR(i, j)] = sums.xx[PAIR(i, j)] - sums.x[i] * centre[j];
  }
  principal_axis(covariance, scale, axis);
  floats along[DIMS];
  floats size = 1e-12f;
  floats offset = 0.0f;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    along[k] = scale[k] * axis[k];
    size += along[k] * axis[k];
    offset -= along[k] * centre[k];
  }
  floats low = LARGEST;
  floats high = -LARGEST;
  for (int t = 0; t < 16; ++t) {
    floats at = offset;
#pragma unroll
    for (int k = 0; k < DIMS; ++k) at += along[k] * TEXEL_OF(x, k, t);
    low = w[t] > 0.0f ? min(low, at) : low;
    high = w[t] > 0.0f ? max(high, at) : high;
  }
  const ints empty = sums.n <= 0.0f;
  low = empty ? (floats)(0.0f) : low / size;
  high = empty ? (floats)(0.0f) : high / size;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    ends[0][k] = centre[k] + low * axis[k];
    ends[1][k] = centre[k] + high * axis[k];
  }
}

// Texels assigned to steps between two ends: sums of weight times step, its square and texel (steps from 0 to 1), and
// the error.
typedef struct {
  floats error;
  floats s, ss, sx[DIMS];
} StepSums;

// Ends that suit such steps best, and the normal equations (a b; b c) of both, the same for every channel: moving the ends
// by p and q costs a p p + 2 b p q + c q q.
typedef struct {
  floats a, b, c;
  floats ideal[2][DIMS];
} EndSystem;

inline EndSystem solve_ends(const StepSums steps, const TexelSums sums) {
  EndSystem system;
  system.a = sums.n - 2.0f * steps.s + steps.ss;
  system.b = steps.s - steps.ss;
  system.c = steps.ss;
  const floats determinant = system.a * system.c - system.b * system.b;
  const ints flat = determinant < 1e-4f * sums.n * sums.n;
  const floats inverse = 1.0f / (flat ? (floats)(1.0f) : determinant);
  const floats per = 1.0f / max(sums.n, (floats)(1e-6f));
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    const floats sx = steps.sx[k];
    const floats rest = sums.x[k] - sx;
    const floats first = flat ? sums.x[k] * per : (system.c * rest - system.b * sx) * inverse;
    const floats second = flat ? sums.x[k] * per : (system.a * sx - system.b * rest) * inverse;
    // A line that few texels hold may run far out; codes end at 255.
    system.ideal[0][k] = min(max(first, (floats)(-255.0f)), (floats)(255.0f));
    system.ideal[1][k] = min(max(second, (floats)(-255.0f)), (floats)(255.0f));
  }
  return system;
}

// What finds the step of a texel between two ends, and decodes it.
typedef struct {
  floats along[DIMS], offset;  // texel to index
  floats span[DIMS], start[DIMS];
} Steps;

// levels  steps between the ends; offset  added to every index before it is rounded
inline Steps steps_of(const floats levels, const float offset, const floats scale[DIMS], const floats ends[2][DIMS]) {
  Steps steps;
  floats size = 0.0f;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    steps.span[k] = ends[1][k] - ends[0][k];
    steps.start[k] = ends[0][k] + HALF_UP;
    size += scale[k] * steps.span[k] * steps.span[k];
  }
  const floats per = size > 1e-3f ? levels / max(size, (floats)(1e-3f)) : (floats)(0.0f);
  steps.offset = offset;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) {
    steps.along[k] = scale[k] * steps.span[k] * per;
    steps.offset -= steps.along[k] * ends[0][k];
  }
  return steps;
}

#endif
