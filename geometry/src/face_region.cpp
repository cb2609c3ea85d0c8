#include "facezip/geometry/face_region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <string>
#include <string_view>

#include "facezip/error.hpp"
#include "facezip/input_file.hpp"

namespace facezip::geometry {
namespace {

constexpr const char* kIndexCure = "count the triangles of the neutral from 0; a quad is two";

void sortUnique(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

int parseIndex(std::string_view word, int triangle_count, const std::string& file, int line) {
  int index = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
  if (error != std::errc() || end != word.data() + word.size() || index < 0 || index >= triangle_count) {
    throw InputError({file, fmt::format("line {}", line),
                      fmt::format("triangle indices from 0 to {}", triangle_count - 1), fmt::format("\"{}\"", word),
                      kIndexCure});
  }
  return index;
}

void parseLine(std::string_view line, int triangle_count, const std::string& file, int number, std::vector<int>& out) {
  line = line.substr(0, line.find('#'));
  constexpr std::string_view kBlank = " \t\r";
  while (true) {
    const std::size_t begin = line.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) return;
    const std::size_t end = std::min(line.find_first_of(kBlank, begin), line.size());
    out.push_back(parseIndex(line.substr(begin, end - begin), triangle_count, file, number));
    line.remove_prefix(end);
  }
}

// Barycentric coordinates of the centroids of the 16 triangles that a 4 by 4 subdivision makes.
std::array<std::array<double, 3>, 16> subdivisionCentroids() {
  constexpr int kSide = 4;
  std::array<std::array<double, 3>, 16> centroids{};
  std::size_t next = 0;
  const auto add = [&](int a, int b) {  // in twelfths
    centroids[next++] = {a / 12.0, b / 12.0, (12 - a - b) / 12.0};
  };
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; i + j < kSide; ++j) {
      add(3 * i + 1, 3 * j + 1);
      if (i + j + 1 < kSide) add(3 * i + 2, 3 * j + 2);
    }
  }
  return centroids;
}

std::vector<int> checkedTriangles(const TriangleMesh& mesh, std::span<const int> triangles) {
  std::vector<int> sorted(triangles.begin(), triangles.end());
  sortUnique(sorted);
  if (sorted.empty()) {
    throw InputError({"", "face region", "at least one triangle", "none", "paint or list the part that changes"});
  }
  const Eigen::Index count = mesh.triangles.rows();
  for (const int index : {sorted.front(), sorted.back()}) {
    if (index >= 0 && index < count) continue;
    throw InputError({"", "face region", fmt::format("triangle indices from 0 to {}", count - 1), std::to_string(index),
                      kIndexCure});
  }
  return sorted;
}

// Mesh vertices that the triangles use, ascending.
std::vector<int> usedVertices(const TriangleMesh& mesh, const std::vector<int>& triangles) {
  std::vector<int> vertices;
  vertices.reserve(3 * triangles.size());
  for (const int t : triangles) {
    for (int corner = 0; corner < 3; ++corner) vertices.push_back(mesh.triangles(t, corner));
  }
  sortUnique(vertices);
  for (const int vertex : vertices) {
    if (vertex >= 0 && vertex < mesh.positions.rows() && mesh.positions.row(vertex).allFinite()) continue;
    throw InputError({"", fmt::format("vertex {} of the mesh", vertex), "a finite position", "none or not finite",
                      "check the mesh"});
  }
  return vertices;
}

// For each used vertex the place in `vertices` of the first at the same position.
std::vector<int> firstCoincident(const TriangleMesh& mesh, const std::vector<int>& vertices) {
  std::vector<int> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const auto p = mesh.positions.row(vertices[static_cast<std::size_t>(i)]);
    return std::array<double, 3>{p[0], p[1], p[2]};
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<int> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i - 1]) == key(order[i]);
    first[static_cast<std::size_t>(order[i])] = same ? first[static_cast<std::size_t>(order[i - 1])] : order[i];
  }
  return first;
}

// Fills the maps between mesh and region vertices.
void numberVertices(const TriangleMesh& mesh, const std::vector<int>& vertices, CoincidentVertices coincident,
                    RegionMesh& region) {
  std::vector<int> first(vertices.size());
  std::iota(first.begin(), first.end(), 0);
  if (coincident == CoincidentVertices::kWeld) first = firstCoincident(mesh, vertices);
  region.region_vertices.assign(static_cast<std::size_t>(mesh.positions.rows()), -1);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto representative = static_cast<std::size_t>(first[i]);  // at or before i: numbered already
    int& number = region.region_vertices[static_cast<std::size_t>(vertices[i])];
    if (representative == i) {
      number = static_cast<int>(region.mesh_vertices.size());
      region.mesh_vertices.push_back(vertices[i]);
    } else {
      number = region.region_vertices[static_cast<std::size_t>(vertices[representative])];
    }
  }
}

int rootOf(std::vector<int>& parents, int vertex) {
  while (parents[static_cast<std::size_t>(vertex)] != vertex) {
    int& parent = parents[static_cast<std::size_t>(vertex)];
    parent = parents[static_cast<std::size_t>(parent)];  // halve the path
    vertex = parent;
  }
  return vertex;
}

// Union of the corners of each triangle; the root of a set is its lowest vertex.
void findComponents(RegionMesh& region) {
  std::vector<int> parents(static_cast<std::size_t>(region.vertexCount()));
  std::iota(parents.begin(), parents.end(), 0);
  for (int t = 0; t < region.triangleCount(); ++t) {
    for (int corner = 1; corner < 3; ++corner) {
      const int a = rootOf(parents, region.triangles(t, 0));
      const int b = rootOf(parents, region.triangles(t, corner));
      parents[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  region.components.resize(parents.size());
  for (int v = 0; v < region.vertexCount(); ++v) {
    const int root = rootOf(parents, v);
    region.components[static_cast<std::size_t>(v)] =
        root == v ? region.component_count++ : region.components[static_cast<std::size_t>(root)];
  }
}

}  // namespace

std::vector<int> readTriangleIndices(const std::filesystem::path& file, int triangle_count) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{256} << 20;
  std::istringstream stream(InputFile(file, "a list of triangle indices", "check the path").read(kMostBytes));
  std::vector<int> indices;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    parseLine(line, triangle_count, file.string(), number, indices);
  }
  if (indices.empty()) {
    throw InputError({file.string(), "", "at least one triangle index", "none", "list the triangles of the face"});
  }
  sortUnique(indices);
  return indices;
}

std::vector<int> wholeMeshRegion(const TriangleMesh& mesh) {
  std::vector<int> triangles(static_cast<std::size_t>(mesh.triangles.rows()));
  std::iota(triangles.begin(), triangles.end(), 0);
  return triangles;
}

std::vector<int> regionFromPredicate(const TriangleMesh& mesh, const std::function<bool(double u, double v)>& painted) {
  static const auto kSamples = subdivisionCentroids();
  std::vector<int> triangles;
  for (int t = 0; t < mesh.uv_triangles.rows(); ++t) {
    std::size_t hits = 0;
    for (const auto& weights : kSamples) {
      Eigen::RowVector2d uv = Eigen::RowVector2d::Zero();
      for (int corner = 0; corner < 3; ++corner) {
        uv += weights[static_cast<std::size_t>(corner)] * mesh.uvs.row(mesh.uv_triangles(t, corner));
      }
      hits += painted(uv[0], uv[1]) ? 1 : 0;
    }
    if (2 * hits > kSamples.size()) triangles.push_back(t);
  }
  return triangles;
}

RegionMesh extractRegion(const TriangleMesh& mesh, std::span<const int> triangles, CoincidentVertices coincident) {
  RegionMesh region;
  region.mesh_triangles = checkedTriangles(mesh, triangles);
  numberVertices(mesh, usedVertices(mesh, region.mesh_triangles), coincident, region);

  region.positions.resize(static_cast<Eigen::Index>(region.mesh_vertices.size()), 3);
  for (Eigen::Index v = 0; v < region.positions.rows(); ++v) {
    region.positions.row(v) = mesh.positions.row(region.mesh_vertices[static_cast<std::size_t>(v)]);
  }
  region.triangles.resize(static_cast<Eigen::Index>(region.mesh_triangles.size()), 3);
  for (Eigen::Index t = 0; t < region.triangles.rows(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = mesh.triangles(region.mesh_triangles[static_cast<std::size_t>(t)], corner);
      region.triangles(t, corner) = region.region_vertices[static_cast<std::size_t>(vertex)];
    }
  }
  findComponents(region);
  return region;
}

}  // namespace facezip::geometry
