#include "facezip/geometry/laplacian.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace facezip::geometry {
namespace {

// Pairs (lower vertex, higher vertex), each once.
std::vector<std::pair<int, int>> uniqueEdges(const RegionMesh& region) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(3 * static_cast<std::size_t>(region.triangleCount()));
  for (int t = 0; t < region.triangleCount(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto edge = std::minmax({region.triangles(t, corner), region.triangles(t, (corner + 1) % 3)});
      if (edge.first != edge.second) edges.push_back(edge);
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

Eigen::SparseMatrix<double> combinatorialLaplacian(const RegionMesh& region) {
  const auto edges = uniqueEdges(region);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * edges.size());
  for (const auto& [a, b] : edges) {
    entries.emplace_back(a, b, -1.0);
    entries.emplace_back(b, a, -1.0);
    entries.emplace_back(a, a, 1.0);
    entries.emplace_back(b, b, 1.0);
  }
  Eigen::SparseMatrix<double> laplacian(region.vertexCount(), region.vertexCount());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

}  // namespace facezip::geometry
