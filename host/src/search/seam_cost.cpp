#include "search/seam_cost.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <span>

#include "device/pooled_buffer.hpp"
#include "search/centred_gram.hpp"

namespace facezip::compress {
namespace {

/// Centred matrices of pairs first .. first + count - 1, and what to multiply their tables with.
struct PackedPairs {
  std::vector<float> grams;
  std::vector<double> scales;
  std::vector<cl_int> masks;
};

PackedPairs packPairs(const GramMatrices& grams, int first, int count, int padded) {
  const std::size_t entries = toSize(padded, padded);
  PackedPairs packed{std::vector<float>(entries * toSize(count)), std::vector<double>(toSize(count)), {}};
  tbb::parallel_for(0, count, [&](int j) {
    const auto index = toSize(j);
    packed.scales[index] = packCentredGram(grams.slot(grams.slots.pair(first + j)), OriginRow::kWith, padded,
                                           std::span(packed.grams).subspan(index * entries, entries));
  });
  for (int j = first; j < first + count; ++j) {
    const MaskPair& pair = grams.slots.pairs[toSize(j)];
    packed.masks.insert(packed.masks.end(), {pair.k, pair.l});
  }
  return packed;
}

}  // namespace

cl::Event launchSeamCost(device::DeviceContext& context, const SeamCostLaunch& launch) {
  const int blocks = paddedFragments(launch.expressions, OriginRow::kWith) / kFragmentLanes;
  const cl::Kernel kernel =
      context.kernel("seam_cost.cl", "seam_cost", fmt::format("-D CLUSTERS={} -D BLOCKS={}", launch.clusters, blocks));
  const std::size_t local = context.workGroupSize(kernel, 64);
  const std::size_t entries = toSize(launch.pairs, launch.clusters, launch.clusters);
  return context.launch(kernel, device::WorkItems(roundUp(entries, local)).inGroupsOf(local), launch.gram,
                        launch.pair_masks, launch.labels, launch.tables, launch.expressions, launch.pairs);
}

SeamTables computeSeamTables(device::DeviceContext& context, const GramMatrices& grams, const Clustering& clustering,
                             std::size_t batch_bytes) {
  const int pairs = static_cast<int>(grams.slots.pairs.size());
  const std::size_t table = toSize(clustering.clusters, clustering.clusters);
  SeamTables tables{
      .masks = clustering.masks, .clusters = clustering.clusters, .pairs = grams.slots.pairs, .values = {}};
  tables.values.reserve(table * toSize(pairs));

  const int padded = paddedFragments(grams.expressions, OriginRow::kWith);
  const std::size_t pair_bytes = toSize(padded, padded) * sizeof(float);
  const int batch = static_cast<int>(std::clamp<std::size_t>(batch_bytes / pair_bytes, 1, 1 << 20));
  const cl::Buffer labels =
      context.upload(std::vector<std::uint8_t>(clustering.labels.begin(), clustering.labels.end()), "cluster labels");

  device::PooledBuffer gram(context, "centred Gram matrices of pairs", CL_MEM_READ_ONLY);
  device::PooledBuffer pair_masks(context, "masks of pairs", CL_MEM_READ_ONLY);
  device::PooledBuffer table_values(context, "seam cost tables", CL_MEM_WRITE_ONLY);
  for (int first = 0; first < pairs; first += batch) {
    const int count = std::min(batch, pairs - first);
    const PackedPairs packed = packPairs(grams, first, count, padded);
    std::vector<float> values(table * toSize(count));
    launchSeamCost(context, {.pairs = count,
                             .expressions = grams.expressions,
                             .clusters = clustering.clusters,
                             .gram = gram.upload(packed.grams),
                             .pair_masks = pair_masks.upload(packed.masks),
                             .labels = labels,
                             .tables = table_values.reserve(values.size() * sizeof(float))});
    table_values.read(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      tables.values.push_back(packed.scales[i / table] * static_cast<double>(values[i]));
    }
  }
  return tables;
}

}  // namespace facezip::compress
