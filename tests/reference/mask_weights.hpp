// mask_weights.hpp - the masks of FaceZip 3.1 by dense elimination, for small meshes. Independent of facezip and of
// Eigen.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

namespace reference {

using Matrix = std::vector<std::vector<double>>;

/// Degree minus adjacency over the distinct edges of the triangles.
inline Matrix combinatorialLaplacian(std::size_t vertex_count, const std::vector<std::array<int, 3>>& triangles) {
  std::set<std::pair<int, int>> neighbours;
  for (const auto& t : triangles) {
    for (const auto& [a, b] : {std::pair{t[0], t[1]}, std::pair{t[1], t[2]}, std::pair{t[2], t[0]}}) {
      if (a == b) continue;
      neighbours.insert({a, b});
      neighbours.insert({b, a});
    }
  }
  Matrix laplacian(vertex_count, std::vector<double>(vertex_count, 0.0));
  for (const auto& [a, b] : neighbours) {
    laplacian[static_cast<std::size_t>(a)][static_cast<std::size_t>(a)] += 1;
    laplacian[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] -= 1;
  }
  return laplacian;
}

/// Solves a x = b for all columns of b by Gauss elimination with partial pivoting.
inline Matrix eliminate(Matrix a, Matrix b) {
  const std::size_t n = a.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t pivot = i;
    for (std::size_t r = i + 1; r < n; ++r) {
      if (std::abs(a[r][i]) > std::abs(a[pivot][i])) pivot = r;
    }
    std::swap(a[i], a[pivot]);
    std::swap(b[i], b[pivot]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == i) continue;
      const double factor = a[r][i] / a[i][i];
      for (std::size_t c = i; c < n; ++c) a[r][c] -= factor * a[i][c];
      for (std::size_t c = 0; c < b[r].size(); ++c) b[r][c] -= factor * b[i][c];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (double& value : b[i]) value /= a[i][i];
  }
  return b;
}

/// #V by K: column k minimises |L phi|^2 with phi = 1 at samples[k] and 0 at the other samples. Solves the whole system
/// of the Lagrangian, 2 L^T L phi + C^T lambda = 0 and C phi = e_k, instead of leaving out rows.
inline Matrix maskWeights(std::size_t vertex_count, const std::vector<std::array<int, 3>>& triangles,
                          const std::vector<int>& samples) {
  const Matrix laplacian = combinatorialLaplacian(vertex_count, triangles);
  const std::size_t size = vertex_count + samples.size();
  Matrix system(size, std::vector<double>(size, 0.0));
  for (std::size_t i = 0; i < vertex_count; ++i) {
    for (std::size_t j = 0; j < vertex_count; ++j) {
      for (std::size_t k = 0; k < vertex_count; ++k) system[i][j] += 2 * laplacian[k][i] * laplacian[k][j];
    }
  }
  Matrix values(size, std::vector<double>(samples.size(), 0.0));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto vertex = static_cast<std::size_t>(samples[k]);
    system[vertex_count + k][vertex] = 1;
    system[vertex][vertex_count + k] = 1;
    values[vertex_count + k][k] = 1;
  }
  Matrix solution = eliminate(std::move(system), std::move(values));
  solution.resize(vertex_count);
  return solution;
}

}  // namespace reference
