// permutation_solver.hpp - the best permutation that all solvers find, and how far from the optimum it can be.
#pragma once

#include <cstdint>
#include <vector>

#include "facezip/compress.hpp"
#include "search/permutation_search.hpp"

namespace facezip::compress {

struct PermutationSolverOptions {
  PermutationSolver solver = PermutationSolver::kBest;
  PermutationSearchOptions descent = {};  ///< random restarts
  int max_iterations = 100;               ///< of message passing, 0 or more
  /// Of branch and bound: nodes times K C!, which is what a node takes time for; 0 or more. The default allows five
  /// masks of four clusters more nodes than there are permutations, and takes about half a second where it is used up.
  std::int64_t branching_budget = 100'000'000;
};

struct PermutationSolution {
  Permutation best;         ///< lowest cost
  bool by_descent = false;  ///< whether a random restart found it, as where costs are the same; else message passing
  PermutationRestarts descent;  ///< random restarts; empty if the solver is message passing alone
  /// Lower bound of the seam cost of any permutation, in the unit of its cost; never above best.cost.
  double bound = 0.0;
  /// Entry 0: the pairs' minima alone; entry s: after iteration s of message passing; never falling.
  std::vector<double> bounds;
};

/// Solves FaceZip Eq. 3 over all permutations, and bounds it from below.
///
/// The primal is the best of coordinate descent from random starts (the paper's), from starts grown greedily from every
/// mask, and from what message passing decodes to after every iteration. The bound is message passing's, raised by
/// branch and bound to the optimum where that is small enough. Beyond C = kMaxListedClusters there is no message
/// passing: the bound is pairwiseBound(). The bound is the same whichever solver gives the permutation. The result
/// depends on `tables` and `options` alone. Throws InputError for options outside their ranges.
PermutationSolution solvePermutation(const SeamTables& tables, const PermutationSolverOptions& options = {});

}  // namespace facezip::compress
