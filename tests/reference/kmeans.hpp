// kmeans.hpp - k-means++ and Lloyd's iterations on the fragments themselves, in double.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace reference {

using Points = std::vector<std::vector<double>>;

inline double squaredDistance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// SplitMix64 of a chain of counters: the stream that facezip documents for its draws.
inline std::uint64_t hashOfCounters(std::uint64_t seed, std::uint64_t major, std::uint64_t minor, std::uint64_t draw) {
  const std::uint64_t golden = 0x9e3779b97f4a7c15u;
  const auto mix = [](std::uint64_t x) {
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    x ^= x >> 31;
    return x;
  };
  std::uint64_t h = mix(seed + golden);
  for (const std::uint64_t counter : {major, minor, draw}) h = mix(h + (counter + 1) * golden);
  return h;
}

struct KmeansRun {
  std::vector<int> labels;
  bool converged = false;
  int refills = 0;  ///< empty clusters that were given a fragment
};

inline std::vector<std::size_t> drawSeeds(const Points& points, int clusters, std::uint64_t seed, int mask,
                                          int restart) {
  const auto draw = [&](int c) {
    return hashOfCounters(seed, static_cast<std::uint64_t>(mask), static_cast<std::uint64_t>(restart),
                          static_cast<std::uint64_t>(c));
  };
  std::vector<std::size_t> seeds = {static_cast<std::size_t>(((draw(0) >> 32) * points.size()) >> 32)};
  std::vector<double> nearest(points.size());
  for (int c = 1; c < clusters; ++c) {
    double total = 0.0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      nearest[n] = std::numeric_limits<double>::infinity();
      for (const std::size_t s : seeds) nearest[n] = std::min(nearest[n], squaredDistance(points[n], points[s]));
      total += nearest[n];
    }
    if (total == 0.0) break;
    const double target = static_cast<double>(draw(c) >> 40) / (1 << 24) * total;
    double sum = 0.0;
    std::size_t n = 0;
    while (n + 1 < points.size() && (sum += nearest[n]) <= target) ++n;
    seeds.push_back(n);
  }
  return seeds;
}

/// Labels of the nearest of `centres`; an empty vector is no centre. Ties go to the lowest.
inline std::vector<int> nearestCentres(const Points& points, const Points& centres) {
  std::vector<int> labels(points.size(), 0);
  for (std::size_t n = 0; n < points.size(); ++n) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < centres.size(); ++c) {
      if (centres[c].empty()) continue;
      const double distance = squaredDistance(points[n], centres[c]);
      if (distance < best) {
        best = distance;
        labels[n] = static_cast<int>(c);
      }
    }
  }
  return labels;
}

/// Mean of every cluster's members; an empty vector for an empty cluster.
inline Points meansOf(const Points& points, const std::vector<int>& labels, int clusters) {
  Points centres(static_cast<std::size_t>(clusters));
  for (std::size_t c = 0; c < centres.size(); ++c) {
    double members = 0.0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (labels[n] != static_cast<int>(c)) continue;
      if (centres[c].empty()) centres[c].assign(points[n].size(), 0.0);
      for (std::size_t i = 0; i < points[n].size(); ++i) centres[c][i] += points[n][i];
      members += 1.0;
    }
    for (double& value : centres[c]) value /= members;
  }
  return centres;
}

/// Gives every empty cluster, the lowest first, the fragment that is farthest from its centre and not alone in its
/// cluster.
inline int refillEmpty(const Points& points, const Points& centres, std::vector<int>& labels) {
  int refills = 0;
  for (std::size_t c = 0; c < centres.size(); ++c) {
    if (std::count(labels.begin(), labels.end(), static_cast<int>(c)) > 0) continue;
    double farthest = 0.0;
    std::size_t chosen = points.size();
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (std::count(labels.begin(), labels.end(), labels[n]) < 2) continue;
      const double distance = squaredDistance(points[n], centres[static_cast<std::size_t>(labels[n])]);
      if (distance > farthest) {
        farthest = distance;
        chosen = n;
      }
    }
    if (chosen == points.size()) break;
    labels[chosen] = static_cast<int>(c);
    ++refills;
  }
  return refills;
}

/// Lloyd's iterations from these centres until the labels stand still.
inline KmeansRun lloyd(const Points& points, Points centres, int max_iterations) {
  const int clusters = static_cast<int>(centres.size());
  KmeansRun run;
  run.labels = nearestCentres(points, centres);
  for (int i = 0; i < max_iterations && !run.converged; ++i) {
    centres = meansOf(points, run.labels, clusters);
    std::vector<int> labels = nearestCentres(points, centres);
    run.refills += refillEmpty(points, centres, labels);
    run.converged = labels == run.labels;
    run.labels = labels;
  }
  return run;
}

inline KmeansRun kmeans(const Points& points, int clusters, int max_iterations, std::uint64_t seed, int mask,
                        int restart) {
  Points centres;
  for (const std::size_t s : drawSeeds(points, clusters, seed, mask, restart)) centres.push_back(points[s]);
  centres.resize(static_cast<std::size_t>(clusters));  // fewer distinct points than clusters: no centre
  return lloyd(points, centres, max_iterations);
}

inline double inertia(const Points& points, const std::vector<int>& labels, int clusters) {
  const Points centres = meansOf(points, labels, clusters);
  double sum = 0.0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    sum += squaredDistance(points[n], centres[static_cast<std::size_t>(labels[n])]);
  }
  return sum;
}

}  // namespace reference
