// seam_cost.cl - how badly cluster a of mask k fits cluster b of mask l where the masks overlap (FaceZip Eq. 3, 4)
//   table[pair][a][b] = |(D'_ak - D'_bl) M_k M_l|^2 = sum_{n,m} e_n e_m H[n,m],   e = 1_a / |a| - 1_b / |b|
// The centre of an empty cluster is the zero fragment (the neutral), which is row N of H: e_N = [a empty] - [b empty].
// e sums to zero, so H may be centred, and e is formed before anything is multiplied: equal clusters cost exactly 0.
//
// NDRange  global {roundUp(pairs * C * C, WGS)}, local {WGS}: work-item = one entry, lanes = 16 fragments
// Buffers  gram        in   [pairs][PADDED][PADDED] float  H of the pair's weights (M_k M_l)^2, centred, scaled to a
//                                                          diagonal of at most 1; the origin is row N; zero padding
//          pair_masks  in   [pairs][2] int                 k, l
//          labels      in   [masks][fragments] uchar       in [0, CLUSTERS)
//          tables      out  [pairs][C][C] float            >= 0, in units of the scaled H
// Defines  CLUSTERS    C, 1 to 8 (4)
//          BLOCKS      blocks of 16 rows, PADDED = 16 * BLOCKS >= fragments + 1 (2)

#include "common.h"

#ifndef CLUSTERS
#define CLUSTERS 4
#endif
#ifndef BLOCKS
#define BLOCKS 2
#endif
#define LANES FACEZIP_VECTOR
#define PADDED (LANES * BLOCKS)

// 1 / number of members of `cluster`, 0 for an empty one.
float member_share(global const uchar* label, int fragments, int cluster) {
  int members = 0;
  for (int n = 0; n < fragments; ++n) members += label[n] == cluster;
  return members > 0 ? 1.0f / (float)members : 0.0f;
}

kernel void seam_cost(global const float* restrict grams, global const int* restrict pair_masks,
                      global const uchar* restrict labels, global float* restrict tables, int fragments, int pairs) {
  const ulong entry = get_global_id(0);
  if (entry >= (ulong)pairs * CLUSTERS * CLUSTERS) return;
  // Not with %: / and % together compile to a `freeze`, which Oclgrind does not know.
  const ulong row_of_tables = entry / CLUSTERS;
  const ulong pair = row_of_tables / CLUSTERS;
  const int a = (int)(row_of_tables - pair * CLUSTERS);
  const int b = (int)(entry - row_of_tables * CLUSTERS);
  global const float* gram = grams + pair * PADDED * PADDED;
  global const uchar* label_k = labels + (ulong)pair_masks[2 * pair] * fragments;
  global const uchar* label_l = labels + (ulong)pair_masks[2 * pair + 1] * fragments;

  const float share_a = member_share(label_k, fragments, a);
  const float share_b = member_share(label_l, fragments, b);
  float e[PADDED];
  for (int n = 0; n < PADDED; ++n) e[n] = 0.0f;
  for (int n = 0; n < fragments; ++n) {
    e[n] = (label_k[n] == a ? share_a : 0.0f) - (label_l[n] == b ? share_b : 0.0f);
  }
  e[fragments] = (share_a == 0.0f ? 1.0f : 0.0f) - (share_b == 0.0f ? 1.0f : 0.0f);

  float16 product[BLOCKS];  // H e
  for (int i = 0; i < BLOCKS; ++i) product[i] = (float16)(0.0f);
  for (int n = 0; n <= fragments; ++n) {
    if (e[n] == 0.0f) continue;
    global const float* row = gram + (ulong)n * PADDED;
    for (int i = 0; i < BLOCKS; ++i) product[i] += e[n] * vload16(i, row);
  }
  float cost = 0.0f;  // e^T H e
  for (int i = 0; i < BLOCKS; ++i) vstore16(vload16(i, e) * product[i], i, e);
  for (int n = 0; n <= fragments; ++n) cost += e[n];
  tables[entry] = max(cost, 0.0f);  // a squared length; rounding may leave it a little below zero
}
