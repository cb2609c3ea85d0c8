// bc7_candidates.h - which of BC7's ways to code a block may suit it, from moments of its texels alone.
// A way is a family (mode, and mode 4's index selector) and its partition or rotation, as one number: family * 64 + it.
// Cost of a way = what its lines leave of the texels + share of the variance along them for the steps between their ends + noise of their ends. Lanes keep
// the KEPT cheapest.
// Defines  KEPT    ways that are kept
//          SCAN3   partitions into three that are looked at, 0 to 64
#ifndef FACEZIP_BC7_CANDIDATES_H
#define FACEZIP_BC7_CANDIDATES_H

// Families 0 to 7 are modes; 8 is mode 4 with the finer indices for colour.
#define FAMILIES 9
#define MOMENTS (1 + DIMS + PRODUCTS)

typedef struct {
  floats cost[KEPT];
  ints way[KEPT];
} Candidates;

inline void consider(Candidates* kept, floats cost, const int number) {
  if (!ANY(cost < kept->cost[KEPT - 1])) return;
  ints way = number;
#pragma unroll
  for (int k = 0; k < KEPT; ++k) {
    const ints less = cost < kept->cost[k];
    const floats next_cost = less ? kept->cost[k] : cost;
    const ints next_way = less ? kept->way[k] : way;
    kept->cost[k] = less ? cost : kept->cost[k];
    kept->way[k] = less ? way : kept->way[k];
    cost = next_cost;
    way = next_way;
  }
}

// What a block of a family costs, from what its lines leave, what lies along them, the variance of the plane that is
// alone, and n, the sum of weights. Fitted to the errors of blocks that were coded.
constant float kCosts[FAMILIES][5] = {
    {1.4f, 0.005f, 0.0f, 1.85f, 1.9f},      // rest, along, variance, n, sqrt(n * along)
    {1.01f, 0.0089f, 0.0f, 1.36f, 0.0f},
    {1.0f, 0.02f, 0.0f, 1.82f, 1.83f},
    {1.12f, 0.0139f, 0.0f, 0.48f, 0.0f},
    {1.20f, 0.0211f, 0.0f, 1.19f, 0.72f},
    {1.40f, 0.0f, 0.0048f, 0.42f, 0.20f},
    {1.0f, 0.0f, 0.0f, 0.0f, 0.0f},
    {1.1f, 0.05f, 0.0f, 1.5f, 1.2f},
    {1.20f, 0.0f, 0.0508f, 1.25f, 0.386f}};

inline floats family_cost(const int family, const floats rest, const floats along, const floats variance, const floats n) {
  floats cost = rest * kCosts[family][0] + n * kCosts[family][3];
  if (kCosts[family][1] > 0.0f) cost += along * kCosts[family][1];
  if (kCosts[family][2] > 0.0f) cost += variance * kCosts[family][2];
  if (kCosts[family][4] > 0.0f) cost += sqrt(n * along) * kCosts[family][4];
  return cost;
}

// Largest eigenvalue of a symmetric matrix, from below: tr C^4 / tr C^3.
inline floats largest_eigenvalue(const floats c[PRODUCTS]) {
  floats third = 1e-20f;
  floats fourth = 0.0f;
#pragma unroll
  for (int i = 0; i < DIMS; ++i) {
#pragma unroll
    for (int j = 0; j <= i; ++j) {
      floats square = 0.0f;
#pragma unroll
      for (int k = 0; k < DIMS; ++k) square += c[PAIR_OF(i, k)] * c[PAIR_OF(j, k)];
      const floats twice = i == j ? square : 2.0f * square;
      third += twice * c[PAIR(i, j)];
      fourth += twice * square;
    }
  }
  return fourth / third;
}

// Adds to `along` and `rest` what of the texels with those moments lies along their line, and what beside it.
inline void measure_subset(const floats moments[MOMENTS], floats* along, floats* rest) {
  const floats per = 1.0f / max(moments[0], (floats)(1e-6f));
  floats covariance[PRODUCTS];
  floats trace = 0.0f;
#pragma unroll
  for (int i = 0; i < DIMS; ++i) {
#pragma unroll
    for (int j = 0; j <= i; ++j) {
      covariance[PAIR(i, j)] = moments[1 + DIMS + PAIR(i, j)] - moments[1 + i] * moments[1 + j] * per;
    }
    trace += covariance[PAIR(i, i)];
  }
  const floats largest = largest_eigenvalue(covariance);
  *along += largest;
  *rest += max(trace - largest, (floats)(0.0f));
}

inline void add_texels(const floats moments[16][MOMENTS], uint texels, floats sums[MOMENTS]) {
#pragma unroll
  for (int k = 0; k < MOMENTS; ++k) sums[k] = 0.0f;
  for (; texels != 0; texels &= texels - 1) {
    const int t = 31 - clz((int)(texels & -texels));
#pragma unroll
    for (int k = 0; k < MOMENTS; ++k) sums[k] += moments[t][k];
  }
}

inline void consider_two_subsets(const floats moments[16][MOMENTS], const floats total[MOMENTS], const floats n, const floats opaque_cost, Candidates* kept) {
  for (int p = 0; p < 64; ++p) {
    floats second[MOMENTS], first[MOMENTS];
    add_texels(moments, kTwoSubsets[p], second);
#pragma unroll
    for (int k = 0; k < MOMENTS; ++k) first[k] = total[k] - second[k];
    floats along = 0.0f, rest = 0.0f;
    measure_subset(first, &along, &rest);
    measure_subset(second, &along, &rest);
    consider(kept, family_cost(1, rest, along, 0.0f, n) + opaque_cost, 1 * 64 + p);
    consider(kept, family_cost(3, rest, along, 0.0f, n) + opaque_cost, 3 * 64 + p);
#if DIMS == 4
    consider(kept, family_cost(7, rest, along, 0.0f, n), 7 * 64 + p);
#endif
  }
}

#if SCAN3 > 0
inline void consider_three_subsets(const floats moments[16][MOMENTS], const floats total[MOMENTS], const floats n, const floats opaque_cost, Candidates* kept) {
  for (int p = 0; p < SCAN3; ++p) {
    uint masks[2] = {0, 0};
    for (int t = 0; t < 16; ++t) {
      const uint subset = kThreeSubsets[p] >> (2 * t) & 3u;
      if (subset > 0) masks[subset - 1] |= 1u << t;
    }
    floats first[MOMENTS], second[MOMENTS], third[MOMENTS];
    add_texels(moments, masks[0], second);
    add_texels(moments, masks[1], third);
#pragma unroll
    for (int k = 0; k < MOMENTS; ++k) first[k] = total[k] - second[k] - third[k];
    floats along = 0.0f, rest = 0.0f;
    measure_subset(first, &along, &rest);
    measure_subset(second, &along, &rest);
    measure_subset(third, &along, &rest);
    if (p < 16) consider(kept, family_cost(0, rest, along, 0.0f, n) + opaque_cost, 0 * 64 + p);
    consider(kept, family_cost(2, rest, along, 0.0f, n) + opaque_cost, 2 * 64 + p);
  }
}
#endif

// One channel of its own, the others on a line. Rotation r swaps channel r - 1 with alpha, which is a plane of its own.
inline void consider_rotations(const floats total[MOMENTS], const floats n, Candidates* kept) {
  const floats per = 1.0f / max(total[0], (floats)(1e-6f));
  for (int rotation = DIMS == 3; rotation < 4; ++rotation) {
    const int alone = rotation == 0 ? 3 : rotation - 1;
    floats covariance[PRODUCTS];
    floats trace = 0.0f;
    floats variance = 0.0f;
#pragma unroll
    for (int i = 0; i < DIMS; ++i) {
#pragma unroll
      for (int j = 0; j <= i; ++j) {
        const floats value = total[1 + DIMS + PAIR(i, j)] - total[1 + i] * total[1 + j] * per;
        covariance[PAIR(i, j)] = i == alone || j == alone ? (floats)(0.0f) : value;
        if (i == j && i == alone) variance = value;
      }
      trace += covariance[PAIR(i, i)];
    }
    const floats along = largest_eigenvalue(covariance);
    const floats rest = max(trace - along, (floats)(0.0f));
    consider(kept, family_cost(5, rest, along, variance, n), 5 * 64 + rotation);
    consider(kept, family_cost(4, rest, along, variance, n), 4 * 64 + rotation);
    consider(kept, family_cost(8, rest, along, variance, n), 8 * 64 + rotation);
  }
}

// opaque  error of alpha, where it is none
inline void find_candidates(const floats* x, const floats* w, const floats scale[DIMS], const floats opaque_cost, Candidates* kept) {
  floats moments[16][MOMENTS];
  floats total[MOMENTS];
  floats root[DIMS];
#pragma unroll
  for (int k = 0; k < DIMS; ++k) root[k] = sqrt(scale[k]);
#pragma unroll
  for (int k = 0; k < MOMENTS; ++k) total[k] = 0.0f;
  for (int t = 0; t < 16; ++t) {
    moments[t][0] = w[t];
#pragma unroll
    for (int i = 0; i < DIMS; ++i) {
      const floats y = TEXEL_OF(x, i, t) * root[i];
      const floats weighted = w[t] * y;
      moments[t][1 + i] = weighted;
#pragma unroll
      for (int j = 0; j <= i; ++j) moments[t][1 + DIMS + PAIR(i, j)] = weighted * (TEXEL_OF(x, j, t) * root[j]);
    }
#pragma unroll
    for (int k = 0; k < MOMENTS; ++k) total[k] += moments[t][k];
  }
  for (int k = 0; k < KEPT; ++k) {
    kept->cost[k] = LARGEST;
    kept->way[k] = 6 * 64;
  }
  floats n = 0.0f;
#pragma unroll
  for (int k = 0; k < DIMS; ++k) n += total[0] * scale[k] * (1.0f / DIMS);
  consider_two_subsets(moments, total, n, opaque_cost, kept);
#if SCAN3 > 0
  consider_three_subsets(moments, total, n, opaque_cost, kept);
#endif
  consider_rotations(total, n, kept);
}

#endif
