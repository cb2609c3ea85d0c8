#include "search/permutation_search.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "io/counts.hpp"
#include "search/coordinate_descent.hpp"
#include "search/counter_hash.hpp"

namespace facezip::compress {
namespace {

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
      std::swap(row[toSize(i)], row[other]);
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

Restart descend(const SeamTables& tables, const CoordinateDescent& descent, const PermutationSearchOptions& options,
                int index) {
  Restart restart{.sigma = randomSigma(tables.masks, tables.clusters, options.seed, index), .sweep_costs = {}};
  restart.sweep_costs.push_back(seamCost(tables, restart.sigma));
  for (int sweep = 0; sweep < options.max_sweeps && !restart.converged; ++sweep) {
    restart.converged = !descent.sweep(restart.sigma);
    restart.sweep_costs.push_back(seamCost(tables, restart.sigma));
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
  const auto clusters = toSize(tables.clusters);
  double cost = 0.0;
  for (std::size_t j = 0; j < tables.pairs.size(); ++j) {
    const int* sigma_k = sigma.data() + toSize(tables.pairs[j].k) * clusters;
    const int* sigma_l = sigma.data() + toSize(tables.pairs[j].l) * clusters;
    for (std::size_t i = 0; i < clusters; ++i) cost += tables.entry(static_cast<int>(j), sigma_k[i], sigma_l[i]);
  }
  return cost;
}

PermutationRestarts searchPermutation(const SeamTables& tables, const PermutationSearchOptions& options) {
  checkOptions(options);
  const CoordinateDescent descent(tables);
  std::vector<Restart> restarts(toSize(options.restarts));
  tbb::parallel_for(0, options.restarts, [&](int index) {
    options.checkpoint();
    restarts[toSize(index)] = descend(tables, descent, options, index);
  });

  PermutationRestarts search;
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

std::vector<double> PermutationRestarts::finalCosts() const {
  std::vector<double> costs;
  for (const auto& restart : sweep_costs) costs.push_back(restart.back());
  return costs;
}

double PermutationRestarts::medianFinalCost() const {
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
