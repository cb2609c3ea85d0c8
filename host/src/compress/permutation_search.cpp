#include "compress/permutation_search.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <limits>
#include <numeric>
#include <utility>

#include "compress/counter_hash.hpp"

namespace facezip::compress {
namespace {

using Assignment = std::array<int, kMaxClusters>;
using CostMatrix = std::array<std::array<double, kMaxClusters>, kMaxClusters>;  // [texture][cluster of the mask]

/// The tables of every mask, seen from that mask: of neighbour l, a C x C table [cluster of l][cluster of k].
class Neighbourhood {
 public:
  explicit Neighbourhood(const SeamTables& tables)
      : clusters_(static_cast<std::size_t>(tables.clusters)), edges_(static_cast<std::size_t>(tables.masks)) {
    for (std::size_t j = 0; j < tables.pairs.size(); ++j) {
      const auto [k, l] = tables.pairs[j];
      assert(k != l);
      std::vector<double> from_k(clusters_ * clusters_), from_l(clusters_ * clusters_);
      for (std::size_t a = 0; a < clusters_; ++a) {
        for (std::size_t b = 0; b < clusters_; ++b) {
          const double cost = tables.values[(j * clusters_ + a) * clusters_ + b];
          from_k[b * clusters_ + a] = cost;
          from_l[a * clusters_ + b] = cost;
        }
      }
      edges_[static_cast<std::size_t>(k)].push_back({l, std::move(from_k)});
      edges_[static_cast<std::size_t>(l)].push_back({k, std::move(from_l)});
    }
  }

  /// costs[i][c]: what texture i pays towards all neighbours of mask k when k gives it cluster c.
  void assignmentCosts(const std::vector<int>& sigma, int k, CostMatrix& costs) const {
    for (auto& row : costs) row.fill(0.0);
    for (const Edge& edge : edges_[static_cast<std::size_t>(k)]) {
      const int* neighbour = sigma.data() + static_cast<std::size_t>(edge.mask) * clusters_;
      for (std::size_t i = 0; i < clusters_; ++i) {
        const double* row = edge.table.data() + static_cast<std::size_t>(neighbour[i]) * clusters_;
        for (std::size_t c = 0; c < clusters_; ++c) costs[i][c] += row[c];
      }
    }
  }

 private:
  struct Edge {
    int mask;
    std::vector<double> table;
  };
  std::size_t clusters_;
  std::vector<std::vector<Edge>> edges_;
};

/// The permutation with the lowest sum of costs[i][assignment[i]], of all C! of them: a subset of clusters is shared
/// out among the first textures at its lowest cost in 2^C C / 2 steps (Held and Karp 1962), 32 where trying all
/// takes 96.
Assignment bestAssignment(const CostMatrix& costs, int clusters) {
  constexpr std::size_t kSubsets = std::size_t{1} << kMaxClusters;
  std::array<double, kSubsets> lowest;
  std::array<int, kSubsets> last;
  lowest[0] = 0.0;
  const unsigned all = (1u << clusters) - 1;
  for (unsigned subset = 1; subset <= all; ++subset) {
    const auto& row = costs[static_cast<std::size_t>(std::popcount(subset)) - 1];
    lowest[subset] = std::numeric_limits<double>::infinity();
    for (int c = 0; c < clusters; ++c) {
      if ((subset >> c & 1u) == 0) continue;
      const double cost = lowest[subset & ~(1u << c)] + row[static_cast<std::size_t>(c)];
      if (cost < lowest[subset]) {
        lowest[subset] = cost;
        last[subset] = c;
      }
    }
  }
  Assignment assignment{};
  for (unsigned subset = all; subset != 0; subset &= ~(1u << last[subset])) {
    assignment[static_cast<std::size_t>(std::popcount(subset)) - 1] = last[subset];
  }
  return assignment;
}

/// Gives mask k its best permutation. Returns whether that lowered the cost: changes within rounding are not made, for
/// they could go round in circles.
bool improveMask(const Neighbourhood& neighbourhood, int k, int clusters, std::vector<int>& sigma) {
  CostMatrix costs;
  neighbourhood.assignmentCosts(sigma, k, costs);
  const Assignment best = bestAssignment(costs, clusters);
  const auto row = sigma.begin() + static_cast<std::ptrdiff_t>(k) * clusters;
  double current_cost = 0.0, best_cost = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(clusters); ++i) {
    current_cost += costs[i][static_cast<std::size_t>(row[static_cast<std::ptrdiff_t>(i)])];
    best_cost += costs[i][static_cast<std::size_t>(best[i])];
  }
  constexpr double kRounding = 1e-12;
  if (!(best_cost < current_cost * (1.0 - kRounding))) return false;
  std::copy_n(best.begin(), clusters, row);
  return true;
}

/// A random permutation per mask (Fisher and Yates), from counters alone.
std::vector<int> randomSigma(int masks, int clusters, std::uint64_t seed, int restart) {
  std::vector<int> sigma;
  for (int k = 0; k < masks; ++k) {
    Assignment row{};
    std::iota(row.begin(), row.begin() + clusters, 0);
    for (int i = clusters - 1; i > 0; --i) {
      const std::uint64_t bits = counterHash(seed, static_cast<std::uint64_t>(restart), static_cast<std::uint64_t>(k),
                                             static_cast<std::uint64_t>(i));
      const std::uint32_t other = boundedDraw(bits, static_cast<std::uint32_t>(i) + 1);
      std::swap(row[static_cast<std::size_t>(i)], row[other]);
    }
    sigma.insert(sigma.end(), row.begin(), row.begin() + clusters);
  }
  return sigma;
}

struct Restart {
  std::vector<int> sigma;
  std::vector<double> sweep_costs;
  bool converged = false;
};

Restart descend(const SeamTables& tables, const Neighbourhood& neighbourhood, const PermutationSearchOptions& options,
                int index) {
  Restart restart{.sigma = randomSigma(tables.masks, tables.clusters, options.seed, index), .sweep_costs = {}};
  restart.sweep_costs.push_back(seamCost(tables, restart.sigma));
  for (int sweep = 0; sweep < options.max_sweeps && !restart.converged; ++sweep) {
    bool changed = false;
    for (int k = 0; k < tables.masks; ++k) {
      changed |= improveMask(neighbourhood, k, tables.clusters, restart.sigma);
    }
    restart.sweep_costs.push_back(seamCost(tables, restart.sigma));
    restart.converged = !changed;
  }
  return restart;
}

void checkOptions(const PermutationSearchOptions& options) {
  const auto require = [](const char* item, int value) {
    if (value >= 1) return;
    throw InputError({.file = "", .item = item, .expected = "1 or more", .got = std::to_string(value), .cure = ""});
  };
  require("restarts", options.restarts);
  require("sweeps", options.max_sweeps);
}

}  // namespace

double seamCost(const SeamTables& tables, const std::vector<int>& sigma) {
  const auto clusters = static_cast<std::size_t>(tables.clusters);
  double cost = 0.0;
  for (std::size_t j = 0; j < tables.pairs.size(); ++j) {
    const int* sigma_k = sigma.data() + static_cast<std::size_t>(tables.pairs[j].k) * clusters;
    const int* sigma_l = sigma.data() + static_cast<std::size_t>(tables.pairs[j].l) * clusters;
    for (std::size_t i = 0; i < clusters; ++i) cost += tables.entry(static_cast<int>(j), sigma_k[i], sigma_l[i]);
  }
  return cost;
}

PermutationSearch searchPermutation(const SeamTables& tables, const PermutationSearchOptions& options) {
  checkOptions(options);
  const Neighbourhood neighbourhood(tables);
  std::vector<Restart> restarts(static_cast<std::size_t>(options.restarts));
  tbb::parallel_for(0, options.restarts, [&](int index) {
    restarts[static_cast<std::size_t>(index)] = descend(tables, neighbourhood, options, index);
  });

  PermutationSearch search;
  search.best = {
      .masks = tables.masks, .clusters = tables.clusters, .sigma = {}, .cost = std::numeric_limits<double>::infinity()};
  for (Restart& restart : restarts) {
    if (restart.sweep_costs.back() < search.best.cost) {
      search.best.cost = restart.sweep_costs.back();
      search.best.sigma = std::move(restart.sigma);
    }
    search.unconverged_restarts += restart.converged ? 0 : 1;
    search.sweep_costs.push_back(std::move(restart.sweep_costs));
  }
  return search;
}

std::vector<double> PermutationSearch::finalCosts() const {
  std::vector<double> costs;
  for (const auto& restart : sweep_costs) costs.push_back(restart.back());
  return costs;
}

double PermutationSearch::medianFinalCost() const {
  std::vector<double> costs = finalCosts();
  std::sort(costs.begin(), costs.end());
  const std::size_t middle = costs.size() / 2;
  return costs.size() % 2 == 1 ? costs[middle] : 0.5 * (costs[middle - 1] + costs[middle]);
}

Permutation identityPermutation(const SeamTables& tables) {
  Permutation identity{.masks = tables.masks, .clusters = tables.clusters, .sigma = {}, .cost = 0.0};
  for (int k = 0; k < tables.masks; ++k) {
    for (int i = 0; i < tables.clusters; ++i) identity.sigma.push_back(i);
  }
  identity.cost = seamCost(tables, identity.sigma);
  return identity;
}

}  // namespace facezip::compress
