#include "search/branch_and_bound.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

class Search {
 public:
  Search(const CycleRelaxation& relaxation, double cost_to_beat, std::int64_t max_nodes)
      : relaxation_(relaxation),
        masks_(toSize(relaxation.masks())),
        order_(toSize(relaxation.group().order())),
        max_nodes_(max_nodes),
        triangles_of_(masks_),
        labels_(masks_, kUnplaced) {
    for (const CycleRelaxation::Triangle& triangle : relaxation.triangles()) {
      for (const int mask : triangle.masks) triangles_of_[toSize(mask)].push_back(&triangle);
    }
    for (int pair = 0; pair < static_cast<int>(relaxation.pairs().size()); ++pair) {
      const auto costs = relaxation.pairCosts(pair);
      const double least = *std::min_element(costs.begin(), costs.end());
      for (const double cost : costs) excess_.push_back(cost - least);
    }
    result_.cost = cost_to_beat;
    open_ = std::numeric_limits<double>::infinity();
  }

  BranchAndBound run() {
    branch(relaxation_.bound(), std::vector<double>(masks_ * order_, 0.0));
    result_.bound = std::min(open_, result_.cost);
    return std::move(result_);
  }

 private:
  static constexpr int kUnplaced = -1;

  /// placed_cost  bound of all permutations that agree with the placed masks, less what other masks pay
  /// extra        K x C!: what each other mask pays towards the placed ones above the minima
  void branch(double placed_cost, const std::vector<double>& extra) {
    double bound = placed_cost;
    int next = kUnplaced;
    double clearest = -1.0;
    for (std::size_t k = 0; k < masks_; ++k) {
      if (labels_[k] != kUnplaced) continue;
      const auto row = std::span(extra).subspan(k * order_, order_);
      const double least = *std::min_element(row.begin(), row.end());
      bound += least;
      // Masks beside placed ones first: another is then the first of a part of its own.
      const double mean = std::accumulate(row.begin(), row.end(), 0.0) / static_cast<double>(order_);
      const double clear = touchesPlaced(static_cast<int>(k)) ? mean - least : -0.5;
      if (clear > clearest) {
        clearest = clear;
        next = static_cast<int>(k);
      }
    }
    if (next == kUnplaced) {
      if (placed_cost < result_.cost) {
        result_.cost = placed_cost;
        result_.labels = labels_;
      }
      return;
    }
    tryLabels(next, placed_cost, bound, extra);
  }

  void tryLabels(int mask, double placed_cost, double bound, const std::vector<double>& extra) {
    const auto row = std::span(extra).subspan(toSize(mask) * order_, order_);
    std::vector<int> by_cost(order_);
    std::iota(by_cost.begin(), by_cost.end(), 0);
    std::stable_sort(by_cost.begin(), by_cost.end(), [&](int a, int b) { return row[toSize(a)] < row[toSize(b)]; });
    const double least = row[toSize(by_cost.front())];
    // Renumbering the textures changes nothing: the first mask of a part needs one permutation only.
    if (!touchesPlaced(mask)) by_cost.resize(1);
    for (const int label : by_cost) {
      const double own = row[toSize(label)];
      const double child_bound = bound - least + own;
      constexpr double kRounding = 1e-9;
      if (child_bound >= result_.cost * (1.0 - kRounding)) return;
      if (result_.nodes >= max_nodes_) {
        open_ = std::min(open_, child_bound);
        return;
      }
      ++result_.nodes;
      labels_[toSize(mask)] = label;
      branch(placed_cost + own, extraWith(mask, extra));
      labels_[toSize(mask)] = kUnplaced;
    }
  }

  bool touchesPlaced(int mask) const {
    const auto& pairs = relaxation_.pairsOf(mask);
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](int pair) { return labels_[toSize(relaxation_.across(pair, mask))] != kUnplaced; });
  }

  /// `extra` once `mask` has its label too.
  std::vector<double> extraWith(int mask, std::vector<double> extra) const {
    const int label = labels_[toSize(mask)];
    for (const int pair : relaxation_.pairsOf(mask)) {
      const auto other = toSize(relaxation_.across(pair, mask));
      if (labels_[other] != kUnplaced) continue;
      const auto costs = std::span(excess_).subspan(toSize(pair) * order_, order_);
      relaxation_.addConditional(costs, pair, static_cast<int>(other), label, extra.data() + other * order_);
    }
    for (const auto* triangle : triangles_of_[toSize(mask)]) addTriangle(*triangle, extra);
    return extra;
  }

  /// Adds what a triangle with two placed masks says of the third.
  void addTriangle(const CycleRelaxation::Triangle& triangle, std::vector<double>& extra) const {
    std::array<int, 3> labels;
    int third = kUnplaced;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      labels[corner] = labels_[toSize(triangle.masks[corner])];
      if (labels[corner] != kUnplaced) continue;
      if (third != kUnplaced) return;
      third = static_cast<int>(corner);
    }
    if (third == kUnplaced) return;
    double* row = extra.data() + toSize(triangle.masks[toSize(third)]) * order_;
    const PermutationGroup& group = relaxation_.group();
    for (std::size_t q = 0; q < order_; ++q) {
      labels[toSize(third)] = static_cast<int>(q);
      const auto& [k, l, m] = labels;
      const int kl = group.product(k, group.inverse(l));
      const int lm = group.product(l, group.inverse(m));
      row[q] += triangle.costs[0][toSize(kl)] + triangle.costs[1][toSize(lm)] +
                triangle.costs[2][toSize(group.product(kl, lm))];
    }
  }

  const CycleRelaxation& relaxation_;
  std::size_t masks_;
  std::size_t order_;
  std::int64_t max_nodes_;
  std::vector<double> excess_;  // pairs x C!, above the pair's minimum
  std::vector<std::vector<const CycleRelaxation::Triangle*>> triangles_of_;
  std::vector<int> labels_;  // K
  double open_;              // lowest bound of what was left out for lack of nodes
  BranchAndBound result_;
};

}  // namespace

BranchAndBound branchAndBound(const CycleRelaxation& relaxation, double cost_to_beat, std::int64_t max_nodes) {
  return Search(relaxation, cost_to_beat, max_nodes).run();
}

}  // namespace facezip::compress
