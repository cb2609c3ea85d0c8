#include "search/group_minimum.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <limits>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

/// The Klein four-group in its order: v after w stands at the place v ^ w. The identity alone below four clusters.
std::vector<int> fourGroup(const PermutationGroup& group) {
  if (group.clusters() < 4) return {0};
  constexpr int kImages[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
  std::vector<int> four;
  for (const auto& images : kImages) {
    for (int element = 0; element < group.order(); ++element) {
      bool same = true;
      for (int c = 0; c < group.clusters(); ++c) same = same && group.image(element, c) == (c < 4 ? images[c] : c);
      if (same) four.push_back(element);
    }
  }
  return four;
}

}  // namespace

GroupMinimum::GroupMinimum(const PermutationGroup& group) : order_(toSize(group.order())) {
  const std::vector<int> four = fourGroup(group);
  lanes_ = four.size();
  std::vector<std::size_t> place_of(order_, order_);
  for (int r = 0; r < group.order(); ++r) {
    if (place_of[toSize(r)] != order_) continue;
    for (const int v : four) {
      const int element = group.product(v, r);
      place_of[toSize(element)] = elements_.size();
      elements_.push_back(element);
      inverses_.push_back(group.inverse(element));
    }
  }
  for (std::size_t coset = 0; coset < order_; coset += lanes_) {
    for (const int b : elements_) {
      const std::size_t place = place_of[toSize(group.product(elements_[coset], b))];
      const std::size_t lane = place % lanes_;
      sources_.push_back(static_cast<std::uint16_t>(lane * order_ + place - lane));
    }
  }
  outer_.resize(order_);
  inner_.resize(lanes_ * order_);
}

template <std::size_t kLanes>
void GroupMinimum::minimum(GroupFunction outer, GroupFunction inner, bool inverse_result, std::span<double> result) {
  using Lanes = Eigen::Array<double, kLanes, 1>;
  const int* outer_at = places(outer.inverse).data();
  const int* inner_at = places(inner.inverse).data();
  const int* result_at = places(inverse_result).data();
  for (std::size_t place = 0; place < order_; ++place) {
    outer_[place] = outer.values[toSize(outer_at[place])];
    const double value = inner.values[toSize(inner_at[place])];
    for (std::size_t v = 0; v < kLanes; ++v) inner_[v * order_ + (place ^ v)] = value;
  }
  const std::uint16_t* sources = sources_.data();
  const auto sums = [&](std::size_t b) { return Eigen::Map<const Lanes>(inner_.data() + sources[b]) + outer_[b]; };
  for (std::size_t coset = 0; coset < order_; coset += kLanes, sources += order_) {
    // Two minima at a time: each waits for its own last.
    Lanes even = sums(0), odd = even;
    for (std::size_t b = 1; b + 1 < order_; b += 2) {
      odd = odd.min(sums(b));
      even = even.min(sums(b + 1));
    }
    even = even.min(odd).min(sums(order_ - 1)).eval();
    for (std::size_t v = 0; v < kLanes; ++v) result[toSize(result_at[coset + v])] = even[v];
  }
}

void GroupMinimum::operator()(GroupFunction outer, GroupFunction inner, bool inverse_result, std::span<double> result) {
  assert(outer.values.size() == order_ && inner.values.size() == order_ && result.size() == order_);
  if (lanes_ == 4) {
    minimum<4>(outer, inner, inverse_result, result);
  } else {
    minimum<1>(outer, inner, inverse_result, result);
  }
}

}  // namespace facezip::compress
