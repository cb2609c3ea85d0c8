// cycle_relaxation.hpp - a lower bound of the seam cost, by message passing between pairs and triangles of masks.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "io/counts.hpp"
#include "search/group_minimum.hpp"
#include "search/permutation_group.hpp"
#include "search/seam_cost.hpp"

namespace facezip::compress {

/// The permutation search as a problem in relative permutations, and its dual.
///
/// The seam cost of masks k and l (Eq. 3) depends on rho_kl = sigma_k sigma_l^-1 alone: renumbering the textures
/// changes nothing. So the search is to choose rho of every pair, at a cost f_kl(rho) that one table of C! entries
/// gives, such that rho_kl rho_lm = rho_km around every cycle. Leaving all cycles out gives the sum of the pairs'
/// minima as a bound; this class keeps the cycles of three masks (Sontag et al. 2008, "Tightening LP relaxations for
/// MAP using message passing") and raises the bound by sequential tree-reweighted message passing (Kolmogorov 2006,
/// "Convergent tree-reweighted message passing for energy minimization", section 3; 2015, "A new look at reweighted
/// message passing", for factors of more than two). Pairs are its nodes, triangles its factors: costs move from one to
/// the other, their sum over every labelling stays, and the sum of all minima never falls.
///
/// The form with sigma_k as the labels says nothing until a mask is held fixed, since without that every label is as
/// good as every other; with one fixed it keeps the triangles at that mask only, and leaves several times the gap.
class CycleRelaxation {
 public:
  struct Triangle {
    std::array<int, 3> masks;  ///< k < l < m
    std::array<int, 3> pairs;  ///< (k, l), (l, m) and (k, m); in the order of all pairs (k, l) comes first, (l, m) last
    /// C! costs of each pair's relative permutation.
    std::array<std::vector<double>, 3> costs;
  };

  /// tables         C in 1 .. kMaxListedClusters
  /// max_triangles  triangles kept at most, 0 or more: those that alone would raise the bound most
  CycleRelaxation(const SeamTables& tables, int max_triangles);

  /// One forward and one backward pass: 6 C!^2 additions for each triangle.
  void iterate();

  /// Below the seam cost of every permutation, but for rounding; never falling from one iteration to the next.
  double bound() const;

  /// A permutation of every mask, as numbered by group(): from `first` on, the mask that the placed ones have decided
  /// most clearly takes what suits them best, by the pairs' beliefs as they are now.
  /// first  in [0, K); gets the identity
  std::vector<int> decode(int first) const;

  int masks() const { return masks_; }
  const PermutationGroup& group() const { return group_; }
  const std::vector<MaskPair>& pairs() const { return pairs_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// What is left of the cost of a pair, by relative permutation: C! long.
  std::span<const double> pairCosts(int pair) const { return row(pair_costs_, pair); }
  /// The pairs that hold a mask.
  const std::vector<int>& pairsOf(int mask) const { return pairs_of_[toSize(mask)]; }
  /// The other mask of a pair.
  int across(int pair, int mask) const {
    const MaskPair& masks = pairs_[toSize(pair)];
    return masks.k == mask ? masks.l : masks.k;
  }
  /// Adds to sums[q] what `costs` of `pair`, C! long by relative permutation, say of its mask `other` having the
  /// permutation q where the one across has `label`.
  void addConditional(std::span<const double> costs, int pair, int other, int label, double* sums) const;

 private:
  struct Corner {
    int triangle;
    int side;  // which of its three pairs
  };
  enum class Direction { kForward, kBackward };

  std::span<const double> row(const std::vector<double>& values, int pair) const;
  void keepTriangles(const std::vector<int>& pair_of, int max_triangles);
  double gain(const Triangle& triangle);
  void visit(int pair, Direction direction);

  int masks_;
  PermutationGroup group_;
  GroupMinimum minimum_;
  std::vector<MaskPair> pairs_;  // rising; visited in this order and back
  std::vector<double> pair_costs_;
  std::vector<double> beliefs_;  // what all triangles and the pair itself said when iterate() last came by
  std::vector<Triangle> triangles_;
  std::vector<std::vector<Corner>> corners_;  // of every pair
  std::vector<std::vector<int>> pairs_of_;    // of every mask
  std::vector<double> scratch_;
};

/// Sum over pairs of the cost of their best relative permutation, an assignment problem each: a lower bound of the seam
/// cost for any C, and exact where masks overlap in a tree.
double pairwiseBound(const SeamTables& tables);

}  // namespace facezip::compress
