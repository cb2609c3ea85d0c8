// permutation_search.hpp - which cluster of every mask goes into which difference texture (FaceZip Eq. 3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "io/counts.hpp"
#include "search/seam_cost.hpp"

namespace facezip::compress {

/// sigma(i, k): the cluster that mask k gives to difference texture i.
struct Permutation {
  int masks = 0;           ///< K
  int clusters = 0;        ///< C
  std::vector<int> sigma;  ///< K x C: sigma[k * C + i]; every row is a permutation of 0 .. C - 1
  /// Seam cost, in units of (1/255)^2. Every pair of masks counts once; Eq. 3 as printed runs over both orders of a
  /// pair, which doubles the value and moves no minimum.
  double cost = 0.0;

  int cluster(int k, int i) const { return sigma[Layout(masks, clusters)(k, i)]; }
};

struct PermutationSearchOptions {
  int restarts = 100;    ///< random starts, 1 or more; the paper takes 100
  int max_sweeps = 100;  ///< visits to all masks in one restart at most, 1 or more; the paper takes 10
  std::uint64_t seed = 1;
  std::function<void()> checkpoint = [] {};  ///< called between steps, from any thread; what it throws ends the search
};

/// What the restarts found.
struct PermutationRestarts {
  Permutation best;  ///< lowest cost; ties go to the lowest restart
  /// Cost of every restart: entry 0 of the random start, entry s after sweep s; never rising. For a convergence plot.
  std::vector<std::vector<double>> sweep_costs;
  int unconverged_restarts = 0;  ///< restarts that still improved in their last sweep

  /// Costs that the restarts ended at, in the order of the restarts.
  std::vector<double> finalCosts() const;
  /// Median of finalCosts(): the mean of the middle two of an even number.
  double medianFinalCost() const;
};

/// Coordinate descent from random starts: masks are visited in rising order, each takes the best of all C! permutations
/// while the others stand, until a sweep changes nothing. Restarts run in parallel; the result depends on `tables`
/// and `options` alone.
/// Throws InputError for options outside their ranges.
PermutationRestarts searchPermutation(const SeamTables& tables, const PermutationSearchOptions& options = {});

/// Clusters in the order they came in, sigma(i, k) = i, with its cost: the paper's baseline without permutation.
Permutation identityPermutation(const SeamTables& tables);

/// Seam cost of `sigma` (K x C): sum over pairs (k, l) and textures i of T_kl[sigma(i, k)][sigma(i, l)].
double seamCost(const SeamTables& tables, const std::vector<int>& sigma);

}  // namespace facezip::compress
