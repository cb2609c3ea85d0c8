// permutation_group.hpp - all C! permutations of the clusters as one table of products.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/counts.hpp"

namespace facezip::compress {

/// Most clusters whose permutations are listed: 5! = 120, where 6! = 720 would make a pair's table of all pairs of
/// permutations half a million entries.
inline constexpr int kMaxListedClusters = 5;

/// The symmetric group of C elements. Permutations are numbered in lexicographic order; 0 is the identity.
class PermutationGroup {
 public:
  using Element = std::array<std::uint8_t, kMaxListedClusters>;

  /// clusters  C, 1 to kMaxListedClusters
  explicit PermutationGroup(int clusters);

  int clusters() const { return clusters_; }
  /// C!
  int order() const { return static_cast<int>(elements_.size()); }
  /// Where `element` takes c.
  int image(int element, int c) const { return elements_[toSize(element)][toSize(c)]; }
  /// Row of products, C! long: entry b is a after b.
  const std::uint8_t* times(int a) const { return products_.data() + toSize(a) * elements_.size(); }
  int product(int a, int b) const { return times(a)[b]; }
  int inverse(int a) const { return inverses_[toSize(a)]; }

 private:
  int clusters_;
  std::vector<Element> elements_;
  std::vector<std::uint8_t> products_;  // C! x C!
  std::vector<int> inverses_;
};

}  // namespace facezip::compress
