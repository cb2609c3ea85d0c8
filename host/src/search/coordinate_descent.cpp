#include "search/coordinate_descent.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>
#include <numeric>
#include <utility>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

/// How much a mask would lose by taking any permutation instead of its best: the mean of all C! less the lowest.
double regret(const CostMatrix& costs, double lowest, int clusters) {
  double sum = 0.0;
  for (int i = 0; i < clusters; ++i) {
    const auto& row = costs[toSize(i)];
    sum += std::accumulate(row.begin(), row.begin() + clusters, 0.0);
  }
  return sum / clusters - lowest;
}

}  // namespace

double assignmentCost(const CostMatrix& costs, const Assignment& assignment, int clusters) {
  double cost = 0.0;
  for (std::size_t i = 0; i < toSize(clusters); ++i) {
    cost += costs[i][toSize(assignment[i])];
  }
  return cost;
}

Assignment bestAssignment(const CostMatrix& costs, int clusters) {
  constexpr std::size_t kSubsets = std::size_t{1} << kMaxClusters;
  std::array<double, kSubsets> lowest;
  std::array<int, kSubsets> last;
  lowest[0] = 0.0;
  const unsigned all = (1u << clusters) - 1;
  for (unsigned subset = 1; subset <= all; ++subset) {
    const auto& row = costs[toSize(std::popcount(subset)) - 1];
    lowest[subset] = std::numeric_limits<double>::infinity();
    for (unsigned rest = subset; rest != 0; rest &= rest - 1) {
      const int c = std::countr_zero(rest);
      const double cost = lowest[subset & ~(1u << c)] + row[toSize(c)];
      if (cost < lowest[subset]) {
        lowest[subset] = cost;
        last[subset] = c;
      }
    }
  }
  Assignment assignment{};
  for (unsigned subset = all; subset != 0; subset &= ~(1u << last[subset])) {
    assignment[toSize(std::popcount(subset)) - 1] = last[subset];
  }
  return assignment;
}

CoordinateDescent::CoordinateDescent(const SeamTables& tables)
    : clusters_(tables.clusters), neighbours_(toSize(tables.masks)) {
  const auto side = toSize(clusters_);
  for (std::size_t j = 0; j < tables.pairs.size(); ++j) {
    const auto [k, l] = tables.pairs[j];
    assert(k != l);
    std::vector<double> from_k(side * side), from_l(side * side);
    for (std::size_t a = 0; a < side; ++a) {
      for (std::size_t b = 0; b < side; ++b) {
        const double cost = tables.values[(j * side + a) * side + b];
        from_k[b * side + a] = cost;
        from_l[a * side + b] = cost;
      }
    }
    neighbours_[toSize(k)].push_back({l, std::move(from_k)});
    neighbours_[toSize(l)].push_back({k, std::move(from_l)});
  }
}

CostMatrix CoordinateDescent::costsOf(const std::vector<int>& sigma, int k) const {
  CostMatrix costs{};
  const auto side = toSize(clusters_);
  for (const Neighbour& neighbour : neighbours_[toSize(k)]) {
    const int* placed = sigma.data() + toSize(neighbour.mask) * side;
    for (std::size_t i = 0; i < side; ++i) {
      const double* row = neighbour.table.data() + toSize(placed[i]) * side;
      for (std::size_t c = 0; c < side; ++c) costs[i][c] += row[c];
    }
  }
  return costs;
}

bool CoordinateDescent::improve(std::vector<int>& sigma, int k) const {
  const CostMatrix costs = costsOf(sigma, k);
  const auto row = sigma.begin() + static_cast<std::ptrdiff_t>(k) * clusters_;
  Assignment current{};
  std::copy_n(row, clusters_, current.begin());
  const Assignment best = bestAssignment(costs, clusters_);
  // Changes within rounding are not made, for they could go round in circles.
  constexpr double kRounding = 1e-12;
  const double bar = assignmentCost(costs, current, clusters_) * (1.0 - kRounding);
  if (!(assignmentCost(costs, best, clusters_) < bar)) return false;
  std::copy_n(best.begin(), clusters_, row);
  return true;
}

bool CoordinateDescent::sweep(std::vector<int>& sigma) const {
  bool changed = false;
  for (int k = 0; k < static_cast<int>(neighbours_.size()); ++k) changed |= improve(sigma, k);
  return changed;
}

void CoordinateDescent::descend(std::vector<int>& sigma) const {
  while (sweep(sigma)) {
  }
}

void CoordinateDescent::place(std::vector<Candidate>& candidates, int k) const {
  const auto side = toSize(clusters_);
  Candidate& placed = candidates[toSize(k)];
  placed.placed = true;
  for (const Neighbour& neighbour : neighbours_[toSize(k)]) {
    Candidate& other = candidates[toSize(neighbour.mask)];
    if (other.placed) continue;
    for (std::size_t i = 0; i < side; ++i) {
      const auto cluster = toSize(placed.best[i]);
      for (std::size_t c = 0; c < side; ++c) other.costs[i][c] += neighbour.table[c * side + cluster];
    }
    other.best = bestAssignment(other.costs, clusters_);
    other.regret = regret(other.costs, assignmentCost(other.costs, other.best, clusters_), clusters_);
  }
}

std::vector<int> CoordinateDescent::grow(int first) const {
  Candidate unplaced;
  std::iota(unplaced.best.begin(), unplaced.best.end(), 0);
  std::vector<Candidate> candidates(neighbours_.size(), unplaced);
  int next = first;
  while (next >= 0) {
    place(candidates, next);
    // Ties, as between masks that touch nothing placed, go to the lowest mask.
    next = -1;
    for (int k = 0; k < static_cast<int>(candidates.size()); ++k) {
      const Candidate& candidate = candidates[toSize(k)];
      if (candidate.placed) continue;
      if (next < 0 || candidate.regret > candidates[toSize(next)].regret) next = k;
    }
  }
  std::vector<int> sigma;
  for (const Candidate& candidate : candidates) {
    sigma.insert(sigma.end(), candidate.best.begin(), candidate.best.begin() + clusters_);
  }
  return sigma;
}

}  // namespace facezip::compress
