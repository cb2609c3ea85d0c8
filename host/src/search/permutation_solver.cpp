#include "search/permutation_solver.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <future>
#include <limits>
#include <utility>

#include "io/counts.hpp"
#include "search/branch_and_bound.hpp"
#include "search/coordinate_descent.hpp"
#include "search/cycle_relaxation.hpp"

namespace facezip::compress {
namespace {

/// Triangles kept: sixteen to a mask take in what raises the bound. With 120 permutations a triangle takes 25 times as
/// long as with 24, and three to a mask have to do.
int maxTriangles(const SeamTables& tables) { return tables.masks * (tables.clusters < kMaxListedClusters ? 16 : 3); }

/// Masks to grow starts from: all, but for a few of them with so many clusters that each takes 20 ms.
int growthStarts(const SeamTables& tables) {
  return tables.clusters <= kMaxListedClusters ? tables.masks : std::min(tables.masks, 16);
}

/// The lowest permutation seen so far, each taken to its local minimum first.
class Incumbent {
 public:
  explicit Incumbent(const SeamTables& tables) : tables_(tables), descent_(tables) {
    best_.masks = tables.masks;
    best_.clusters = tables.clusters;
    best_.cost = std::numeric_limits<double>::infinity();
  }

  void offer(std::vector<int> sigma) {
    descent_.descend(sigma);
    offerLocalMinimum(std::move(sigma));
  }

  void offerGrown(const std::function<void()>& checkpoint) {
    const int starts = growthStarts(tables_);
    std::vector<std::vector<int>> grown(toSize(starts));
    tbb::parallel_for(0, starts, [&](int start) {
      checkpoint();
      auto& sigma = grown[toSize(start)];
      sigma = descent_.grow(start * tables_.masks / starts);
      descent_.descend(sigma);
    });
    for (auto& sigma : grown) offerLocalMinimum(std::move(sigma));
  }

  const Permutation& best() const { return best_; }

 private:
  void offerLocalMinimum(std::vector<int> sigma) {
    const double cost = seamCost(tables_, sigma);
    if (!(cost < best_.cost)) return;
    best_.cost = cost;
    best_.sigma = std::move(sigma);
  }

  const SeamTables& tables_;
  CoordinateDescent descent_;
  Permutation best_;
};

std::vector<int> sigmaOf(const PermutationGroup& group, const std::vector<int>& labels) {
  std::vector<int> sigma;
  for (const int label : labels) {
    for (int i = 0; i < group.clusters(); ++i) sigma.push_back(group.image(label, i));
  }
  return sigma;
}

/// Raises the bound and lowers the incumbent until they meet, the bound stands still or the iterations are used up.
void passMessages(CycleRelaxation& relaxation, const PermutationSolverOptions& options, Incumbent& incumbent,
                  std::vector<double>& bounds) {
  // An iteration that closes less than this share of the gap is not worth its time: a hundred more would not halve it.
  constexpr double kStandsStill = 1e-3;
  constexpr double kClosed = 1e-9;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    options.descent.checkpoint();
    const double gap = incumbent.best().cost - bounds.back();
    if (gap <= kClosed * incumbent.best().cost) return;
    relaxation.iterate();
    // Rounding may lower what stands still.
    bounds.push_back(std::max(bounds.back(), relaxation.bound()));
    incumbent.offer(sigmaOf(relaxation.group(), relaxation.decode(iteration % relaxation.masks())));
    if (bounds.back() - bounds[bounds.size() - 2] < kStandsStill * gap) return;
  }
}

double bestBound(const SeamTables& tables, const PermutationSolverOptions& options, Incumbent& incumbent,
                 std::vector<double>& bounds) {
  bounds = {pairwiseBound(tables)};
  if (tables.clusters > kMaxListedClusters) return bounds.back();
  CycleRelaxation relaxation(tables, maxTriangles(tables));
  passMessages(relaxation, options, incumbent, bounds);
  const std::int64_t node_size = std::int64_t{tables.masks} * relaxation.group().order();
  const BranchAndBound search = branchAndBound(relaxation, incumbent.best().cost, options.branching_budget / node_size);
  if (!search.labels.empty()) incumbent.offer(sigmaOf(relaxation.group(), search.labels));
  return std::max(bounds.back(), search.bound);
}

}  // namespace

PermutationSolution solvePermutation(const SeamTables& tables, const PermutationSolverOptions& options) {
  PermutationSolution solution;
  std::future<PermutationRestarts> descent;  // beside the messages, which keep one thread busy
  if (options.solver != PermutationSolver::kMessagePassing) {
    descent = std::async(std::launch::async, [&] { return searchPermutation(tables, options.descent); });
  }
  Incumbent incumbent(tables);
  incumbent.offerGrown(options.descent.checkpoint);
  solution.bound = bestBound(tables, options, incumbent, solution.bounds);
  if (descent.valid()) {
    solution.descent = descent.get();
    solution.best = solution.descent.best;
  }
  solution.by_descent = options.solver == PermutationSolver::kDescent ||
                        (options.solver == PermutationSolver::kBest && solution.best.cost <= incumbent.best().cost);
  if (!solution.by_descent) solution.best = incumbent.best();
  solution.bound = std::min(solution.bound, solution.best.cost);
  return solution;
}

}  // namespace facezip::compress
