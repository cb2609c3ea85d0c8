// compress_stretch.hpp - reference of compress and stretch maps (Li et al. 2020, Eq. 10 to 13), in double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

namespace facezip::reference {

using Point = std::array<double, 3>;

/// E(x): mean length of the edges that meet at each vertex.
inline std::vector<double> ringLengths(const std::vector<Point>& points,
                                       const std::vector<std::array<int, 3>>& triangles) {
  std::vector<std::set<int>> ring(points.size());
  for (const auto& t : triangles) {
    for (int c = 0; c < 3; ++c) {
      const int a = t[static_cast<std::size_t>(c)], b = t[static_cast<std::size_t>((c + 1) % 3)];
      if (a == b) continue;
      ring[static_cast<std::size_t>(a)].insert(b);
      ring[static_cast<std::size_t>(b)].insert(a);
    }
  }
  std::vector<double> lengths(points.size(), 0.0);
  for (std::size_t v = 0; v < points.size(); ++v) {
    for (const int other : ring[v]) {
      const Point& q = points[static_cast<std::size_t>(other)];
      lengths[v] += std::hypot(points[v][0] - q[0], points[v][1] - q[1], points[v][2] - q[2]) /
                    static_cast<double>(ring[v].size());
    }
  }
  return lengths;
}

/// Eq. 12 of one texel, with the influences divided by `unit` first.
inline std::vector<double> normalised(const std::vector<double>& influences, double unit) {
  std::vector<double> shares;
  double sum = 0.0;
  for (const double influence : influences) sum += std::exp(influence / unit);
  for (const double influence : influences) shares.push_back(std::exp(influence / unit) / sum);
  return shares;
}

/// Weight of a grid with cells of `scale` texels at a texel: linear between the cells' centres, the edge repeats.
/// at(row, column) gives a cell.
template <typename At>
double bilinear(int x, int y, int scale, int columns, int rows, const At& at) {
  const auto place = [scale](int texel, int cells) {
    return std::clamp((texel + 0.5) / scale - 0.5, 0.0, static_cast<double>(cells - 1));
  };
  const double u = place(x, columns), v = place(y, rows);
  const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
  const int x1 = std::min(x0 + 1, columns - 1), y1 = std::min(y0 + 1, rows - 1);
  const double s = u - x0, t = v - y0;
  return (1 - t) * ((1 - s) * at(y0, x0) + s * at(y0, x1)) + t * ((1 - s) * at(y1, x0) + s * at(y1, x1));
}

}  // namespace facezip::reference
