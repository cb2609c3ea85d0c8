// coordinate_descent.hpp - moves that change the permutation of one mask at a time (FaceZip, "Permutation").
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "search/kmeans.hpp"
#include "search/seam_cost.hpp"

namespace facezip::compress {

/// Entry i: the cluster of texture i; entries from C on are not used.
using Assignment = std::array<int, kMaxClusters>;
/// [texture][cluster]: what a texture pays for a cluster.
using CostMatrix = std::array<std::array<double, kMaxClusters>, kMaxClusters>;

/// Sum over textures of costs[i][assignment[i]], of `clusters` of them.
double assignmentCost(const CostMatrix& costs, const Assignment& assignment, int clusters);

/// The permutation with the lowest assignmentCost() of all C!: a subset of clusters is shared out among the first
/// textures at its lowest cost in 2^C C / 2 steps (Held and Karp 1962), 32 where trying all takes 96.
/// clusters  C, 1 to kMaxClusters
Assignment bestAssignment(const CostMatrix& costs, int clusters);

/// Coordinate descent and greedy starts for it. Holds the tables of every mask as seen from that mask.
class CoordinateDescent {
 public:
  explicit CoordinateDescent(const SeamTables& tables);

  /// Visits all masks in rising order; each takes its best permutation while the others stand. Returns whether one
  /// changed.
  /// sigma  K x C, as Permutation::sigma
  bool sweep(std::vector<int>& sigma) const;

  /// Sweeps until nothing changes.
  void descend(std::vector<int>& sigma) const;

  /// A greedy labelling, K x C: `first` keeps the identity, then the mask that the placed ones have decided most
  /// clearly takes the permutation that suits them best, until all are placed. Where it starts matters little, that
  /// it grows from one place does: random starts join regions that agreed on different orders.
  /// first  in [0, K)
  std::vector<int> grow(int first) const;

 private:
  struct Neighbour {
    int mask;
    std::vector<double> table;  // C x C: [cluster of the neighbour][cluster of this mask]
  };

  /// A mask that grow() has yet to place.
  struct Candidate {
    CostMatrix costs{};   // towards the masks placed so far
    Assignment best{};    // of these costs
    double regret = 0.0;  // what any permutation costs more than the best, on average
    bool placed = false;
  };

  CostMatrix costsOf(const std::vector<int>& sigma, int k) const;
  bool improve(std::vector<int>& sigma, int k) const;
  void place(std::vector<Candidate>& candidates, int k) const;

  int clusters_;
  std::vector<std::vector<Neighbour>> neighbours_;  // of every mask
};

}  // namespace facezip::compress
