#include "search/cycle_relaxation.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "io/counts.hpp"
#include "search/coordinate_descent.hpp"

namespace facezip::compress {
namespace {

// Of a triangle's pairs (k, l), (l, m), (k, m), in the order of all pairs.
constexpr int kFirstSide = 0, kLastSide = 1;

double lowest(std::span<const double> values) { return *std::min_element(values.begin(), values.end()); }

/// Where the lowest and the second lowest value are; twice the same of a single value.
std::pair<int, int> lowestTwo(std::span<const double> values) {
  int best = 0, second = values.size() > 1 ? 1 : 0;
  if (values[toSize(second)] < values[0]) std::swap(best, second);
  for (int x = 2; x < static_cast<int>(values.size()); ++x) {
    const double value = values[toSize(x)];
    if (value < values[toSize(best)]) {
      second = std::exchange(best, x);
    } else if (value < values[toSize(second)]) {
      second = x;
    }
  }
  return {best, second};
}

/// f(rho) of one pair, C! long: sum over textures, counted by the cluster b of mask l, of T_kl[rho(b)][b].
void fillRelativeCosts(const SeamTables& tables, int pair, const PermutationGroup& group, double* costs) {
  for (int rho = 0; rho < group.order(); ++rho) {
    costs[rho] = 0.0;
    for (int b = 0; b < group.clusters(); ++b) costs[rho] += tables.entry(pair, group.image(rho, b), b);
  }
}

/// Smallest cost of the triangle by the relative permutation of one of its pairs, C! long: x of (k, l), y of (l, m) and
/// x y of (k, m).
void minMarginals(const CycleRelaxation::Triangle& triangle, int side, GroupMinimum& minimum,
                  std::vector<double>& result) {
  const auto& [kl, lm, km] = triangle.costs;
  if (side == 0) {
    minimum({lm}, {km}, false, result);
  } else if (side == 1) {  // x y is the inverse of y^-1 x^-1
    minimum({kl, true}, {km, true}, true, result);
  } else {  // y = x^-1 (x y) is the inverse of (x y)^-1 x
    minimum({kl}, {lm, true}, true, result);
  }
  const auto& own = triangle.costs[toSize(side)];
  for (std::size_t x = 0; x < result.size(); ++x) result[x] += own[x];
}

}  // namespace

CycleRelaxation::CycleRelaxation(const SeamTables& tables, int max_triangles)
    : masks_(tables.masks), group_(tables.clusters), minimum_(group_), pairs_(tables.pairs) {
  const auto order = toSize(group_.order());
  pair_costs_.resize(pairs_.size() * order);
  scratch_.resize(order);
  std::vector<int> pair_of(toSize(masks_, masks_), -1);
  for (std::size_t j = 0; j < pairs_.size(); ++j) {
    fillRelativeCosts(tables, static_cast<int>(j), group_, pair_costs_.data() + j * order);
    pair_of[toSize(pairs_[j].k * masks_ + pairs_[j].l)] = static_cast<int>(j);
  }
  beliefs_ = pair_costs_;
  pairs_of_.resize(toSize(masks_));
  for (int j = 0; j < static_cast<int>(pairs_.size()); ++j) {
    pairs_of_[toSize(pairs_[toSize(j)].k)].push_back(j);
    pairs_of_[toSize(pairs_[toSize(j)].l)].push_back(j);
  }
  keepTriangles(pair_of, max_triangles);

  corners_.resize(pairs_.size());
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    for (int side = 0; side < 3; ++side) {
      const int pair = triangles_[toSize(t)].pairs[toSize(side)];
      corners_[toSize(pair)].push_back({t, side});
    }
  }
}

std::span<const double> CycleRelaxation::row(const std::vector<double>& values, int pair) const {
  const auto order = toSize(group_.order());
  return std::span(values).subspan(toSize(pair) * order, order);
}

/// How far the triangle's best consistent choice lies above its pairs' minima.
double CycleRelaxation::gain(const Triangle& triangle) {
  Triangle whole = triangle;
  double separate = 0.0;
  for (std::size_t side = 0; side < 3; ++side) {
    const auto costs = pairCosts(triangle.pairs[side]);
    whole.costs[side].assign(costs.begin(), costs.end());
    separate += lowest(costs);
  }
  std::vector<double> marginals(toSize(group_.order()));
  minMarginals(whole, 0, minimum_, marginals);
  return lowest(marginals) - separate;
}

void CycleRelaxation::keepTriangles(const std::vector<int>& pair_of, int max_triangles) {
  std::vector<std::pair<double, Triangle>> candidates;
  const auto pairOf = [&](int k, int l) { return pair_of[toSize(k * masks_ + l)]; };
  for (int kl = 0; kl < static_cast<int>(pairs_.size()); ++kl) {
    const auto [k, l] = pairs_[toSize(kl)];
    for (int m = l + 1; m < masks_; ++m) {
      const int lm = pairOf(l, m), km = pairOf(k, m);
      if (lm < 0 || km < 0) continue;
      Triangle triangle{.masks = {k, l, m}, .pairs = {kl, lm, km}, .costs = {}};
      const double alone = gain(triangle);
      candidates.emplace_back(alone, std::move(triangle));
    }
  }
  // Each triangle costs time whether it helps or not; beyond several to a mask the bound rises no faster per second.
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  if (candidates.size() > toSize(max_triangles)) {
    candidates.resize(toSize(max_triangles));
  }
  for (auto& [alone, triangle] : candidates) {
    for (auto& costs : triangle.costs) costs.assign(toSize(group_.order()), 0.0);
    triangles_.push_back(std::move(triangle));
  }
}

void CycleRelaxation::visit(int pair, Direction direction) {
  const auto order = toSize(group_.order());
  const auto& corners = corners_[toSize(pair)];
  double* costs = pair_costs_.data() + toSize(pair) * order;

  // Collects from every triangle what it says of this pair. Its minimum is then zero whatever the pair chooses.
  int forward = 0, backward = 0;
  for (const auto& [t, side] : corners) {
    Triangle& triangle = triangles_[toSize(t)];
    minMarginals(triangle, side, minimum_, scratch_);
    auto& own = triangle.costs[toSize(side)];
    for (std::size_t x = 0; x < order; ++x) {
      costs[x] += scratch_[x];
      own[x] -= scratch_[x];
    }
    forward += side != kLastSide ? 1 : 0;
    backward += side != kFirstSide ? 1 : 0;
  }
  std::copy_n(costs, order, beliefs_.begin() + static_cast<std::ptrdiff_t>(toSize(pair) * order));

  // Shares it out among the triangles that have pairs to come in this direction.
  const int shares = std::max(forward, backward);
  if (shares == 0) return;
  std::vector<double>& share = scratch_;
  for (std::size_t x = 0; x < order; ++x) share[x] = costs[x] / shares;
  for (const auto& [t, side] : corners) {
    if (side == (direction == Direction::kForward ? kLastSide : kFirstSide)) continue;
    auto& own = triangles_[toSize(t)].costs[toSize(side)];
    for (std::size_t x = 0; x < order; ++x) {
      own[x] += share[x];
      costs[x] -= share[x];
    }
  }
}

void CycleRelaxation::iterate() {
  const int count = static_cast<int>(pairs_.size());
  for (int pair = 0; pair < count; ++pair) visit(pair, Direction::kForward);
  for (int pair = count - 1; pair >= 0; --pair) visit(pair, Direction::kBackward);
}

double CycleRelaxation::bound() const {
  // Going back, the first pair of a triangle is visited last and leaves nothing in it: triangles' minima are zero.
  double sum = 0.0;
  for (int pair = 0; pair < static_cast<int>(pairs_.size()); ++pair) sum += lowest(pairCosts(pair));
  return sum;
}

void CycleRelaxation::addConditional(std::span<const double> costs, int pair, int other, int label,
                                     double* sums) const {
  if (other == pairs_[toSize(pair)].k) {
    const int inverse = group_.inverse(label);
    for (int q = 0; q < group_.order(); ++q) sums[q] += costs[toSize(group_.product(q, inverse))];
  } else {
    const std::uint8_t* products = group_.times(label);
    for (int q = 0; q < group_.order(); ++q) sums[q] += costs[products[group_.inverse(q)]];
  }
}

std::vector<int> CycleRelaxation::decode(int first) const {
  const auto order = toSize(group_.order());
  std::vector<double> sums(toSize(masks_) * order, 0.0);  // towards the masks placed so far
  std::vector<double> regret(toSize(masks_), 0.0);        // of the second best permutation
  std::vector<int> labels(toSize(masks_), 0);             // the best
  std::vector<bool> placed(toSize(masks_), false);
  for (int next = first; next >= 0;) {
    placed[toSize(next)] = true;
    for (const int pair : pairsOf(next)) {
      const auto other = toSize(across(pair, next));
      if (placed[other]) continue;
      double* sum = sums.data() + other * order;
      addConditional(row(beliefs_, pair), pair, static_cast<int>(other), labels[toSize(next)], sum);
      const auto [best, second] = lowestTwo({sum, order});
      labels[other] = best;
      regret[other] = sum[second] - sum[best];
    }
    next = -1;
    for (int k = 0; k < masks_; ++k) {
      if (placed[toSize(k)]) continue;
      if (next < 0 || regret[toSize(k)] > regret[toSize(next)]) next = k;
    }
  }
  return labels;
}

double pairwiseBound(const SeamTables& tables) {
  double bound = 0.0;
  for (int pair = 0; pair < static_cast<int>(tables.pairs.size()); ++pair) {
    CostMatrix costs{};
    for (int a = 0; a < tables.clusters; ++a) {
      for (int b = 0; b < tables.clusters; ++b) {
        costs[toSize(a)][toSize(b)] = tables.entry(pair, a, b);
      }
    }
    bound += assignmentCost(costs, bestAssignment(costs, tables.clusters), tables.clusters);
  }
  return bound;
}

}  // namespace facezip::compress
