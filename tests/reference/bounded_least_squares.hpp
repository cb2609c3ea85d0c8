// bounded_least_squares.hpp - reference: the best of all corners, edges, ... and insides of the box, by brute force.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace facezip::reference {

using Square = std::vector<std::vector<double>>;

/// Solves a x = b by elimination with pivoting; empty where it is singular.
inline std::vector<double> eliminate(Square a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < n; ++i) {
      if (std::fabs(a[i][k]) > std::fabs(a[pivot][k])) pivot = i;
    }
    if (std::fabs(a[pivot][k]) < 1e-12) return {};
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

inline double quadratic(const Square& h, const std::vector<double>& g, const std::vector<double>& x) {
  double value = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    value -= g[i] * x[i];
    for (std::size_t j = 0; j < x.size(); ++j) value += 0.5 * x[i] * h[i][j] * x[j];
  }
  return value;
}

/// Smallest value of 1/2 x^T h x - g^T x in the box: every unknown is at its low bound, its high bound or free, in each
/// of the 3^n ways.
inline double smallestInBox(const Square& h, const std::vector<double>& g, double low, double high) {
  const std::size_t n = g.size();
  std::size_t ways = 1;
  for (std::size_t i = 0; i < n; ++i) ways *= 3;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t way = 0; way < ways; ++way) {
    std::vector<double> x(n, 0.0);
    std::vector<std::size_t> free;
    std::size_t rest = way;
    for (std::size_t i = 0; i < n; ++i, rest /= 3) {
      if (rest % 3 == 2) free.push_back(i);
      x[i] = rest % 3 == 0 ? low : rest % 3 == 1 ? high : 0.0;
    }
    Square a(free.size(), std::vector<double>(free.size()));
    std::vector<double> b(free.size());
    for (std::size_t i = 0; i < free.size(); ++i) {
      b[i] = g[free[i]];
      for (std::size_t j = 0; j < n; ++j) b[i] -= h[free[i]][j] * x[j];
      for (std::size_t j = 0; j < free.size(); ++j) a[i][j] = h[free[i]][free[j]];
    }
    const std::vector<double> inside = eliminate(a, b);
    if (inside.size() != free.size()) continue;
    bool feasible = true;
    for (std::size_t i = 0; i < free.size(); ++i) {
      x[free[i]] = inside[i];
      feasible = feasible && inside[i] >= low && inside[i] <= high;
    }
    if (feasible) best = std::fmin(best, quadratic(h, g, x));
  }
  return best;
}

}  // namespace facezip::reference
