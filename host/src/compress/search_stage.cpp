#include "compress/search_stage.hpp"

#include "compress/compress_stretch.hpp"
#include "search/kmeans.hpp"
#include "search/permutation_solver.hpp"
#include "search/seam_cost.hpp"
#include "search/texture_assignment.hpp"

namespace facezip::compress {
namespace {

Clustering cluster(const GramMatrices& grams, const CompressOptions& options, int differences, const device::Run& run) {
  run.progress.stage("clustering", 0);
  KmeansOptions kmeans;
  kmeans.clusters = differences;
  kmeans.restarts = options.cluster_restarts;
  kmeans.seed = options.seed;
  Clustering clustering = clusterFragments(run.context, grams, kmeans);
  run.clock.book("clustering");
  run.progress.checkCancelled();
  return clustering;
}

struct FoundPermutation {
  Permutation permutation;
  PermutationRecord record;
};

FoundPermutation permute(const SeamTables& tables, const CompressOptions& options, const device::Run& run) {
  if (options.method == Method::kNoPermutation) {
    FoundPermutation found{identityPermutation(tables), {}};
    found.record.cost = found.permutation.cost;
    return found;
  }
  PermutationSolverOptions solver;
  solver.solver = options.permutation_solver;
  solver.descent.restarts = options.restarts;
  solver.descent.seed = options.seed;
  solver.descent.checkpoint = [&run] { run.progress.checkCancelled(); };
  const PermutationSolution solution = solvePermutation(tables, solver);
  PermutationRecord record;
  record.cost = solution.best.cost;
  record.solver = solution.by_descent ? "descent" : "message-passing";
  record.bound = solution.bound;
  record.bounds = solution.bounds;
  record.convergence = solution.descent.sweep_costs;
  record.restart_costs = solution.descent.finalCosts();
  if (!record.restart_costs.empty()) record.median_restart_cost = solution.descent.medianFinalCost();
  return {solution.best, std::move(record)};
}

/// Eq. 6 at every cell: weights are 0 or 1 between masks, so a byte holds them as they are.
EncodedWeights layWeightMaps(const Clustering& clustering, const Permutation& permutation, const GramMatrices& grams,
                             const CellMasks& cells, int differences, const device::Run& run) {
  run.progress.stage("weight maps", 0);
  const std::vector<int> texture_of = textureOfExpression(clustering, permutation);
  WeightMapper mapper(run.context, texture_of, grams.slots.masks, grams.expressions, differences);
  EncodedWeights weights;
  weights.scale.assign(static_cast<std::size_t>(differences), 1.0 / 255.0);
  weights.offset.assign(static_cast<std::size_t>(differences), 0.0);
  weights.codes.resize(mapper.outputBytes(cells.cells()));
  mapper.fillAll(cells, weights.codes);
  run.clock.book("weight maps");
  return weights;
}

}  // namespace

SearchedWeights searchWeights(const GramMatrices& grams, const CellMasks& cells, const CompressOptions& options,
                              int differences, const device::Run& run) {
  const Clustering clustering = cluster(grams, options, differences, run);
  run.progress.stage("permutation", 0);
  const SeamTables tables = computeSeamTables(run.context, grams, clustering);
  run.clock.book("seam costs");
  FoundPermutation found = permute(tables, options, run);
  SearchedWeights searched;
  searched.coefficients = {grams.slots.masks, differences, grams.expressions,
                           differenceCoefficients(clustering, found.permutation)};
  run.clock.book("permutation");
  run.progress.checkCancelled();
  searched.weights = layWeightMaps(clustering, found.permutation, grams, cells, differences, run);
  searched.permutation = std::move(found.record);
  return searched;
}

SearchedWeights influenceWeights(const Capture& capture, const Face& face, const raster::UvRaster& raster,
                                 int weight_scale, const device::Run& run) {
  run.progress.stage("influences", 0);
  const std::vector<Eigen::MatrixX3d> meshes =
      readExpressionMeshes(capture, "its mesh, for its influence", run.progress);
  SearchedWeights searched;
  searched.weights =
      encodeShares(normalisedInfluences(face.mesh, vertexInfluences(face.mesh, meshes), raster, weight_scale));
  run.clock.book("influences");
  return searched;
}

}  // namespace facezip::compress
