// branch_and_bound.hpp - closes the gap that a relaxation leaves, where the search stays small.
#pragma once

#include <cstdint>
#include <vector>

#include "search/cycle_relaxation.hpp"

namespace facezip::compress {

struct BranchAndBound {
  /// K permutations as numbered by the relaxation's group, cheaper than the cost to beat; empty if none was found.
  std::vector<int> labels;
  double cost = 0.0;   ///< of `labels`, or the cost to beat
  double bound = 0.0;  ///< of every permutation: `cost` where the search came to its end
  std::int64_t nodes = 0;
};

/// Depth-first search over the masks, most decided first. What message passing left in pairs and triangles is never
/// negative above their minima, so the bound of a node is the relaxation's and what the placed masks, and every other
/// mask towards them, pay on top.
/// relaxation    after CycleRelaxation::iterate()
/// cost_to_beat  of a known permutation; nodes within 1e-9 of it are not followed
/// max_nodes     0 or more; the result depends on it and never on time
BranchAndBound branchAndBound(const CycleRelaxation& relaxation, double cost_to_beat, std::int64_t max_nodes);

}  // namespace facezip::compress
