// kmeans.hpp - clusters of the fragments of every mask (FaceZip 3.1, "Clustering"; the fragments are Eq. 2).
// The centres are never formed: k-means needs nothing but inner products of fragments.
#pragma once

#include <cstdint>
#include <vector>

#include "device/device_context.hpp"
#include "io/counts.hpp"
#include "search/gram_matrices.hpp"

namespace facezip::compress {

inline constexpr int kMaxClusters = 8;

struct KmeansOptions {
  int clusters = 4;          ///< C, 1 to 8
  int restarts = 64;         ///< independent runs of every mask, 1 or more; the one with the lowest inertia is kept
  int max_iterations = 100;  ///< Lloyd iterations of one run at most, 1 or more
  std::uint64_t seed = 1;
};

/// Which cluster every expression belongs to under every mask.
/// Clusters are numbered as k-means++ drew their seeds in the winning run, that is at random: as they are, they make
/// the paper's "no permutation" baseline. A mask with fewer than C distinct fragments leaves its last clusters empty.
struct Clustering {
  int masks = 0;                ///< K
  int expressions = 0;          ///< N
  int clusters = 0;             ///< C
  std::vector<int> labels;      ///< K x N, each in [0, C)
  std::vector<double> inertia;  ///< K: sum over n of |f_n - its centre|^2, (1/255)^2 units, summed in double
  bool converged = true;        ///< false when a winning run still changed labels in its last iteration

  int label(int k, int n) const { return labels[Layout(masks, expressions)(k, n)]; }
};

/// Clusters the N fragments of each of the K masks: `restarts` runs of k-means++ and Lloyd per mask, all on the device
/// in one launch, the best by inertia in double. The same input, options and device give the same result.
/// grams   slots 1 .. K are read; finite
/// Throws InputError for options outside their ranges; DeviceError.
Clustering clusterFragments(device::DeviceContext& context, const GramMatrices& grams,
                            const KmeansOptions& options = {});

/// What the device returns of all runs.
struct KmeansRuns {
  int masks = 0;
  int restarts = 0;
  int expressions = 0;
  std::vector<std::uint8_t> labels;      ///< K x restarts x N
  std::vector<std::int32_t> iterations;  ///< K x restarts: Lloyd iterations until labels stood still, or -1
};

/// The device part of clusterFragments(): every run of every mask.
KmeansRuns runKmeans(device::DeviceContext& context, const GramMatrices& grams, const KmeansOptions& options);

/// The host part: inertia of every run in double, and the best run of every mask; ties go to the lowest restart.
Clustering selectBestRuns(const GramMatrices& grams, const KmeansRuns& runs, int clusters);

/// Sizes and device buffers of one launch of kernels/cl/kmeans.cl, which describes them.
struct KmeansLaunch {
  int masks = 0;
  int expressions = 0;
  KmeansOptions options;
  cl::Buffer gram;
  cl::Buffer labels;
  cl::Buffer iterations;
};

/// Enqueues the kernel; the caller owns the buffers. For tests and benchmarks.
cl::Event launchKmeans(device::DeviceContext& context, const KmeansLaunch& launch);

/// The K centred matrices in the layout of the kernel's buffer `gram`.
std::vector<float> packKmeansGrams(const GramMatrices& grams);

}  // namespace facezip::compress
