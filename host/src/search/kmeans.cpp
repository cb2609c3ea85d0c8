#include "search/kmeans.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "io/counts.hpp"
#include "search/centred_gram.hpp"

namespace facezip::compress {
namespace {

using Labels = std::span<const std::uint8_t>;

void requireRange(const char* option, long value, long lowest, long highest) {
  if (value >= lowest && value <= highest) return;
  throw InputError({.file = "",
                    .item = option,
                    .expected = fmt::format("{} to {}", lowest, highest),
                    .got = std::to_string(value),
                    .cure = ""});
}

void checkOptions(const KmeansOptions& options) {
  requireRange("clusters", options.clusters, 1, kMaxClusters);
  requireRange("k-means restarts", options.restarts, 1, 1 << 16);
  requireRange("k-means iterations", options.max_iterations, 1, 1 << 16);
}

/// Sum of |f_n - centre|^2 over the members of every cluster, which is sum_n G[n,n] - sum_S 1/|S| sum_{n,m in S}
/// G[n,m]. Clusters are summed in the order of their first member: runs that found the same partition tie to the last
/// bit.
double inertiaOf(const GramMatrices::Matrix& gram, Labels labels) {
  const int n_count = static_cast<int>(labels.size());
  std::array<std::vector<int>, kMaxClusters> members;
  std::vector<int> order;
  for (int n = 0; n < n_count; ++n) {
    auto& cluster = members[labels[toSize(n)]];
    if (cluster.empty()) order.push_back(labels[toSize(n)]);
    cluster.push_back(n);
  }
  double inertia = 0.0;
  for (const int c : order) {
    const std::vector<int>& cluster = members[toSize(c)];
    double own = 0.0, mixed = 0.0;
    for (std::size_t i = 0; i < cluster.size(); ++i) {
      own += gram(cluster[i], cluster[i]);
      for (std::size_t j = 0; j < i; ++j) mixed += gram(cluster[i], cluster[j]);
    }
    inertia += own - (own + 2.0 * mixed) / static_cast<double>(cluster.size());
  }
  return std::max(inertia, 0.0);
}

struct BestRun {
  int restart = 0;
  double inertia = std::numeric_limits<double>::infinity();
};

/// Labels of one run.
Labels labelsOf(const KmeansRuns& runs, int mask, int restart) {
  const auto n = toSize(runs.expressions);
  const auto run = toSize(mask, runs.restarts) + toSize(restart);
  return Labels(runs.labels).subspan(run * n, n);
}

BestRun bestRunOf(const GramMatrices& grams, const KmeansRuns& runs, int mask) {
  const GramMatrices::Matrix gram = grams.slot(grams.slots.mask(mask));
  BestRun best;
  for (int restart = 0; restart < runs.restarts; ++restart) {
    const double inertia = inertiaOf(gram, labelsOf(runs, mask, restart));
    if (inertia < best.inertia) best = {restart, inertia};
  }
  return best;
}

}  // namespace

std::vector<float> packKmeansGrams(const GramMatrices& grams) {
  const int padded = paddedFragments(grams.expressions, OriginRow::kWithout);
  const std::size_t entries = toSize(padded, padded);
  std::vector<float> packed(entries * toSize(grams.slots.masks));
  tbb::parallel_for(0, grams.slots.masks, [&](int k) {
    packCentredGram(grams.slot(grams.slots.mask(k)), OriginRow::kWithout, padded,
                    std::span(packed).subspan(toSize(k) * entries, entries));
  });
  return packed;
}

cl::Event launchKmeans(device::DeviceContext& context, const KmeansLaunch& launch) {
  const int blocks = paddedFragments(launch.expressions, OriginRow::kWithout) / kFragmentLanes;
  const cl::Kernel kernel = context.kernel("kmeans.cl", "kmeans",
                                           fmt::format("-D CLUSTERS={} -D BLOCKS={}", launch.options.clusters, blocks));
  const std::size_t local = context.workGroupSize(kernel, 64);
  const std::size_t runs = toSize(launch.masks, launch.options.restarts);
  return context.launch(kernel, device::WorkItems(roundUp(runs, local)).inGroupsOf(local), launch.gram, launch.labels,
                        launch.iterations, launch.expressions, launch.masks, launch.options.restarts,
                        launch.options.max_iterations, launch.options.seed);
}

KmeansRuns runKmeans(device::DeviceContext& context, const GramMatrices& grams, const KmeansOptions& options) {
  checkOptions(options);
  KmeansRuns runs{.masks = grams.slots.masks,
                  .restarts = options.restarts,
                  .expressions = grams.expressions,
                  .labels = {},
                  .iterations = {}};
  const std::size_t count = toSize(runs.masks, runs.restarts);
  runs.labels.resize(count * toSize(runs.expressions));
  runs.iterations.resize(count);
  if (runs.labels.empty()) return runs;

  const std::size_t iteration_bytes = count * sizeof(std::int32_t);
  const KmeansLaunch launch{.masks = runs.masks,
                            .expressions = runs.expressions,
                            .options = options,
                            .gram = context.upload(packKmeansGrams(grams), "centred Gram matrices"),
                            .labels = context.allocate(runs.labels.size(), CL_MEM_READ_WRITE, "k-means labels"),
                            .iterations = context.allocate(iteration_bytes, CL_MEM_WRITE_ONLY, "k-means iterations")};
  launchKmeans(context, launch);
  context.read(launch.labels, runs.labels, "k-means labels");
  context.read(launch.iterations, runs.iterations, "k-means iterations");
  return runs;
}

Clustering selectBestRuns(const GramMatrices& grams, const KmeansRuns& runs, int clusters) {
  std::vector<BestRun> best(toSize(runs.masks));
  tbb::parallel_for(0, runs.masks, [&](int k) { best[toSize(k)] = bestRunOf(grams, runs, k); });

  Clustering clustering{
      .masks = runs.masks, .expressions = runs.expressions, .clusters = clusters, .labels = {}, .inertia = {}};
  for (int k = 0; k < runs.masks; ++k) {
    const BestRun& run = best[toSize(k)];
    const Labels labels = labelsOf(runs, k, run.restart);
    clustering.labels.insert(clustering.labels.end(), labels.begin(), labels.end());
    clustering.inertia.push_back(run.inertia);
    const auto index = toSize(k, runs.restarts) + toSize(run.restart);
    clustering.converged = clustering.converged && runs.iterations[index] >= 0;
  }
  return clustering;
}

Clustering clusterFragments(device::DeviceContext& context, const GramMatrices& grams, const KmeansOptions& options) {
  return selectBestRuns(grams, runKmeans(context, grams, options), options.clusters);
}

}  // namespace facezip::compress
