// group_minimum.hpp - the smallest sum of two costs over all ways to write a permutation as a product.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "search/permutation_group.hpp"

namespace facezip::compress {

/// A function of permutations, C! long, taken as it stands or as a function of their inverses.
struct GroupFunction {
  std::span<const double> values;
  bool inverse = false;  ///< the value for x is that at the inverse of x
};

/// Convolution over a group with (min, +) in place of (+, *): messages between relative permutations.
///
/// For C of 4 and more four results are formed at once. The permutations are taken in cosets V r of the Klein
/// four-group V, and since V is its own inverse and (v r) b = v (r b), what b makes of a coset is another coset, its
/// four elements exchanged as an exclusive or of their places does.
class GroupMinimum {
 public:
  explicit GroupMinimum(const PermutationGroup& group);

  /// result[a]: the smallest outer(b) + inner(a b) over b; at the inverse of a if `inverse_result`. `result` may not
  /// overlap the others. Not for two threads at once.
  void operator()(GroupFunction outer, GroupFunction inner, bool inverse_result, std::span<double> result);

 private:
  template <std::size_t kLanes>
  void minimum(GroupFunction outer, GroupFunction inner, bool inverse_result, std::span<double> result);

  const std::vector<int>& places(bool inverse) const { return inverse ? inverses_ : elements_; }

  std::size_t order_;
  std::size_t lanes_;  ///< of V: 4, or 1 where there is no V
  // By place: coset after coset, [coset][lane].
  std::vector<int> elements_;
  std::vector<int> inverses_;
  std::vector<std::uint16_t> sources_;  ///< [coset a][place of b]: where the coset a b begins in inner_
  std::vector<double> outer_;           ///< [place]
  std::vector<double> inner_;           ///< [lane v][place p]: the value at p ^ v
};

}  // namespace facezip::compress
