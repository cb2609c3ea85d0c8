#include "compress/search_stage.hpp"

#include "compress/compress_stretch.hpp"
#include "compress/search/kmeans.hpp"
#include "compress/search/permutation_solver.hpp"
#include "compress/search/seam_cost.hpp"
#include "compress/search/texture_assignment.hpp"
#include "compress/search/weight_map.hpp"

namespace facezip::compress {
namespace {

// Li et al. 2020, Eq. 10 to 12: the weights follow from the meshes alone.
void assignInfluences(CompressionState& state, WeightGroup& group) {
  state.progress.stage("influences", 0);
  group.start = normalisedInfluences(
      state.face.mesh,
      vertexInfluences(state.face.mesh, readExpressionMeshes(state.capture, state.face.mesh,
                                                             "its mesh, for its influence", state.progress)),
      *state.maps.maps[state.maps.reference].raster, state.options.weight_scale);
  state.clock.book("influences");
}

Permutation choosePermutation(CompressionState& state, const SeamTables& tables) {
  if (state.options.method == CompressOptions::Method::kNoPermutation) return identityPermutation(tables);
  PermutationSolverOptions solver;
  solver.solver = state.options.permutation_solver;
  solver.descent.restarts = state.options.restarts;
  solver.descent.seed = state.options.seed;
  solver.descent.checkpoint = [&state] { state.progress.checkCancelled(); };
  const PermutationSolution found = solvePermutation(tables, solver);
  state.report.permutation_solver = found.by_descent ? "descent" : "message-passing";
  state.report.permutation_bound = found.bound;
  state.report.permutation_bounds = found.bounds;
  state.report.convergence = found.descent.sweep_costs;
  state.report.restart_costs = found.descent.finalCosts();
  if (!state.report.restart_costs.empty()) state.report.permutation_cost_median = found.descent.medianFinalCost();
  return found.best;
}

}  // namespace

void searchWeights(CompressionState& state, WeightGroup& group) {
  if (state.options.method == CompressOptions::Method::kCompressStretch) {
    assignInfluences(state, group);
    return;
  }
  state.progress.stage("clustering", 0);
  KmeansOptions kmeans;
  kmeans.clusters = state.options.differences;
  kmeans.restarts = state.options.cluster_restarts;
  kmeans.seed = state.options.seed;
  const Clustering clustering = clusterFragments(state.context, group.grams, kmeans);
  state.clock.book("clustering");
  state.progress.checkCancelled();
  state.progress.stage("permutation", 0);
  const SeamTables tables = computeSeamTables(state.context, group.grams, clustering);
  state.clock.book("seam costs");
  const Permutation permutation = choosePermutation(state, tables);
  state.report.permutation_cost = permutation.cost;
  group.coefficients = {state.report.masks, state.options.differences, state.expressions(),
                        differenceCoefficients(clustering, permutation)};
  state.clock.book("permutation");
  state.progress.checkCancelled();
  state.progress.stage("weight maps", 0);
  const std::vector<int> texture_of = textureOfExpression(clustering, permutation);
  WeightMapper mapper(state.context, texture_of, state.report.masks, state.expressions(), state.options.differences);
  const std::size_t cells = state.grid.cells.cells();
  group.start.scale.assign(static_cast<std::size_t>(state.options.differences), 1.0 / 255.0);
  group.start.offset.assign(static_cast<std::size_t>(state.options.differences), 0.0);
  group.start.codes.resize(mapper.outputBytes(cells));
  mapper.fillAll(state.grid.cells, group.start.codes);
  state.clock.book("weight maps");
}

}  // namespace facezip::compress
