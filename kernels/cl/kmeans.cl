// kmeans.cl - k-means over the fragments (Eq. 2) of every mask, on Gram matrices alone (FaceZip 3.1, "Clustering")
//   |f_n - c_S|^2 = H[n,n] - 2/|S| sum_{m in S} H[n,m] + 1/|S|^2 sum_{m,m' in S} H[m,m']
// A run is one restart of one mask: k-means++ seeds (Arthur and Vassilvitskii 2007), then Lloyd's update and assignment
// until the labels stand still. Runs do not meet, so a run is a work-item; its lanes are 16 fragments.
//
// NDRange  global {roundUp(masks * restarts, WGS)}, local {WGS}: run = mask * restarts + restart
// Buffers  gram        in   [masks][PADDED][PADDED] float  H, centred and scaled to a largest diagonal of 1
//                                                          (centred_gram.hpp says why); zero where padded
//          labels      out  [runs][fragments] uchar        in [0, CLUSTERS)
//          iterations  out  [runs] int                     Lloyd iterations until the labels stood still, or -1
// Defines  CLUSTERS    C, 1 to 8 (4)
//          BLOCKS      blocks of 16 fragments, PADDED = 16 * BLOCKS (2)
// Private  (C + 3) * PADDED words: sums, distances, labels and labels before
// Ties     lowest cluster, lowest fragment
// Empty    a cluster that loses all its fragments takes the one farthest from its centre; it stays empty where there is
//          none but coincident fragments, so with N < C the last clusters are empty

#include "common.h"
#include "counter_hash.h"

#ifndef CLUSTERS
#define CLUSTERS 4
#endif
#ifndef BLOCKS
#define BLOCKS 2
#endif
#define LANES FACEZIP_VECTOR
#define PADDED (LANES * BLOCKS)

// A squared distance below this share of the squared lengths it is the difference of is rounding: fragments coincide.
// Between two fragments it is three operations of 2^-24 each; to a centre it is the running sums of up to 128 members.
#define COINCIDENT_FRAGMENTS 1e-6f
#define COINCIDENT_CENTRE 1e-5f

// Index n drawn with probability weight[n] / total.
int draw_by_weight(const float* weight, int fragments, float total, ulong bits) {
  const float target = (float)(bits >> 40) * 0x1p-24f * total;  // 24 bits: exact in a float, below total
  float sum = 0.0f;
  int last = 0;
  for (int n = 0; n < fragments; ++n) {
    if (weight[n] > 0.0f) last = n;
    sum += weight[n];
    if (sum > target) return n;
  }
  return last;
}

// Lowers `nearest` and sets `label` where fragment `seed` is nearer than the seeds of the clusters before `cluster`.
// Returns the sum of `nearest`.
float join_seed(global const float* gram, int fragments, int seed, int cluster, float* nearest, int* label) {
  const float seed_square = gram[(ulong)seed * PADDED + seed];
  float total = 0.0f;
  for (int n = 0; n < fragments; ++n) {
    const float squares = gram[(ulong)n * PADDED + n] + seed_square;
    float distance = squares - 2.0f * gram[(ulong)seed * PADDED + n];
    if (distance <= COINCIDENT_FRAGMENTS * squares) distance = 0.0f;
    if (distance < nearest[n]) {
      nearest[n] = distance;
      label[n] = cluster;
    }
    total += nearest[n];
  }
  return total;
}

// k-means++: the first seed is drawn evenly, every other with the squared distance to its nearest seed as weight. A
// fragment that coincides with a seed is never drawn, so fewer distinct fragments than clusters leave clusters empty.
void seed_clusters(global const float* gram, int fragments, ulong seed, int mask, int restart, float* nearest,
                   int* label) {
  for (int n = 0; n < PADDED; ++n) {
    nearest[n] = MAXFLOAT;
    label[n] = 0;
  }
  const ulong first = ((facezip_counter_hash(seed, mask, restart, 0) >> 32) * (ulong)fragments) >> 32;
  float total = join_seed(gram, fragments, (int)first, 0, nearest, label);
  for (int c = 1; c < CLUSTERS && total > 0.0f; ++c) {
    const int next = draw_by_weight(nearest, fragments, total, facezip_counter_hash(seed, mask, restart, c));
    total = join_seed(gram, fragments, next, c, nearest, label);
  }
}

// Update step: sums[c][n] = sum of H[n,m] over the members m of cluster c, and square[c] = |centre of c|^2.
void update_clusters(global const float* gram, int fragments, const int* label, float* sums, float* size,
                     float* square) {
  for (int i = 0; i < CLUSTERS * BLOCKS; ++i) vstore16((float16)(0.0f), i, sums);
  for (int c = 0; c < CLUSTERS; ++c) size[c] = 0.0f;
  for (int m = 0; m < fragments; ++m) {
    global const float* row = gram + (ulong)m * PADDED;
    const int c = label[m];
    size[c] += 1.0f;
    for (int b = 0; b < BLOCKS; ++b) {
      vstore16(vload16(c * BLOCKS + b, sums) + vload16(b, row), c * BLOCKS + b, sums);
    }
  }
  for (int c = 0; c < CLUSTERS; ++c) square[c] = 0.0f;
  for (int n = 0; n < fragments; ++n) square[label[n]] += sums[label[n] * PADDED + n];
  for (int c = 0; c < CLUSTERS; ++c) square[c] /= max(size[c] * size[c], 1.0f);
}

// Assignment step: the nearest centre of every fragment, and the squared distance to it less H[n,n].
void assign_fragments(const float* sums, const float* size, const float* square, float* nearest, int* label) {
  for (int b = 0; b < BLOCKS; ++b) {
    float16 best = (float16)(MAXFLOAT);
    int16 best_cluster = (int16)(0);
    for (int c = 0; c < CLUSTERS; ++c) {
      if (size[c] == 0.0f) continue;
      const float16 distance = square[c] - (2.0f / size[c]) * vload16(c * BLOCKS + b, sums);
      const int16 nearer = distance < best;
      best = select(best, distance, nearer);
      best_cluster = select(best_cluster, (int16)(c), nearer);
    }
    vstore16(best, b, nearest);
    vstore16(best_cluster, b, label);
  }
}

// Gives every empty cluster the fragment that is farthest from its centre, as long as that distance is not rounding.
void refill_empty_clusters(global const float* gram, int fragments, const float* square, float* nearest, int* label) {
  int members[CLUSTERS];
  for (int c = 0; c < CLUSTERS; ++c) members[c] = 0;
  for (int n = 0; n < fragments; ++n) ++members[label[n]];
  for (int c = 0; c < CLUSTERS; ++c) {
    if (members[c] > 0) continue;
    float farthest = 0.0f;
    int chosen = -1;
    for (int n = 0; n < fragments; ++n) {
      const float own_square = gram[(ulong)n * PADDED + n];
      const float distance = own_square + nearest[n];
      const bool apart = distance > COINCIDENT_CENTRE * (own_square + square[label[n]]);
      if (members[label[n]] > 1 && apart && distance > farthest) {
        farthest = distance;
        chosen = n;
      }
    }
    if (chosen < 0) return;
    --members[label[chosen]];
    label[chosen] = c;
    members[c] = 1;
  }
}

kernel void kmeans(global const float* restrict grams, global uchar* restrict labels, global int* restrict iterations,
                   int fragments, int masks, int restarts, int max_iterations, ulong seed) {
  const ulong run = get_global_id(0);
  if (run >= (ulong)masks * restarts) return;
  const int mask = (int)(run / restarts);
  // Not run % restarts: / and % together compile to a `freeze`, which Oclgrind does not know.
  const int restart = (int)(run - (ulong)mask * restarts);
  global const float* gram = grams + (ulong)mask * PADDED * PADDED;

  float sums[CLUSTERS * PADDED], size[CLUSTERS], square[CLUSTERS], nearest[PADDED];
  int label[PADDED], previous[PADDED];
  seed_clusters(gram, fragments, seed, mask, restart, nearest, label);

  int done = -1;
  for (int i = 1; i <= max_iterations && done < 0; ++i) {
    for (int n = 0; n < fragments; ++n) previous[n] = label[n];
    update_clusters(gram, fragments, label, sums, size, square);
    assign_fragments(sums, size, square, nearest, label);
    refill_empty_clusters(gram, fragments, square, nearest, label);
    int changed = 0;
    for (int n = 0; n < fragments; ++n) changed += previous[n] != label[n];
    if (changed == 0) done = i;
  }
  for (int n = 0; n < fragments; ++n) labels[run * fragments + n] = (uchar)label[n];
  iterations[run] = done;
}
