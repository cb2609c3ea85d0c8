#include "search/permutation_group.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "io/counts.hpp"

namespace facezip::compress {

PermutationGroup::PermutationGroup(int clusters) : clusters_(clusters) {
  assert(clusters >= 1 && clusters <= kMaxListedClusters);
  Element element{};
  std::iota(element.begin(), element.end(), std::uint8_t{0});
  do {
    elements_.push_back(element);
  } while (std::next_permutation(element.begin(), element.begin() + clusters));

  const std::size_t order = elements_.size();
  products_.resize(order * order);
  inverses_.resize(order);
  for (std::size_t a = 0; a < order; ++a) {
    for (std::size_t b = 0; b < order; ++b) {
      Element product = elements_[0];
      for (std::size_t c = 0; c < toSize(clusters); ++c) product[c] = elements_[a][elements_[b][c]];
      const auto found = std::lower_bound(elements_.begin(), elements_.end(), product);
      products_[a * order + b] = static_cast<std::uint8_t>(found - elements_.begin());
      if (found == elements_.begin()) inverses_[a] = static_cast<int>(b);
    }
  }
}

}  // namespace facezip::compress
