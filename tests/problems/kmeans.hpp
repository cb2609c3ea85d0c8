// kmeans.hpp - problem of the step `kmeans`.
#pragma once

#include <optional>

#include "problems/guarded_buffer.hpp"
#include "reference/kmeans.hpp"
#include "search/kmeans.hpp"
#include "search_capture.hpp"

namespace facezip::test {

/// The kernel alone. Operations of all runs: an iteration adds N rows of N, and compares N fragments with C centres by
/// a multiply-add.
struct KmeansProblem {
  KmeansProblem(device::DeviceContext& device, SearchCapture search_capture,
                const compress::KmeansOptions& kmeans_options)
      : context(device), capture(std::move(search_capture)), grams(gramsOf(capture)), options(kmeans_options) {
    const std::size_t runs = toSize(grams.slots.masks, options.restarts);
    labels.emplace(context, runs * toSize(grams.expressions));
    iterations.emplace(context, runs * sizeof(cl_int));
    gram = context.upload(compress::packKmeansGrams(grams), "centred Gram matrices");
  }

  void run() {
    compress::launchKmeans(context, {.masks = grams.slots.masks,
                                     .expressions = grams.expressions,
                                     .options = options,
                                     .gram = gram,
                                     .labels = labels->buffer(),
                                     .iterations = iterations->buffer()});
    context.finish();
  }
  compress::KmeansRuns result() const {
    return {.masks = grams.slots.masks,
            .restarts = options.restarts,
            .expressions = grams.expressions,
            .labels = labels->read<std::uint8_t>(),
            .iterations = iterations->read<std::int32_t>()};
  }
  /// The same run on the fragments themselves, in double.
  reference::KmeansRun expected(int mask, int restart) const {
    return reference::kmeans(capture.fragments(toSize(mask)), options.clusters, options.max_iterations, options.seed,
                             mask, restart);
  }

  double flops() const {
    const double n = grams.expressions;
    double all = 0.0;
    for (const std::int32_t count : result().iterations) all += count < 0 ? options.max_iterations : count;
    return all * (n * n + 2.0 * n * options.clusters);
  }

  device::DeviceContext& context;
  SearchCapture capture;
  compress::GramMatrices grams;
  compress::KmeansOptions options;
  cl::Buffer gram;
  std::optional<GuardedBuffer> labels;
  std::optional<GuardedBuffer> iterations;
};

}  // namespace facezip::test
