// face_region.hpp - the part of the mesh whose textures change, and its mesh.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::geometry {

/// Reads triangle indices (from 0, of the fans that readObj makes) from a text file: integers separated by white space,
/// '#' starts a comment. Returns them sorted, each once.
/// triangle_count  rows of the mesh's triangles; indices lie in [0, triangle_count)
/// Throws InputError naming file and line; also if the file holds no index.
std::vector<int> readTriangleIndices(const std::filesystem::path& file, int triangle_count);

/// All triangles: 0 .. triangle_count - 1.
std::vector<int> wholeMeshRegion(const TriangleMesh& mesh);

/// The triangles that a painted image covers: those of whose 16 sample points (centroids of a 4 by 4 subdivision in
/// UV space) more than half are painted. Returns sorted indices; possibly none.
/// mesh     must have UVs
/// painted  asked with u, v as the mesh has them (v up)
std::vector<int> regionFromPredicate(const TriangleMesh& mesh, const std::function<bool(double u, double v)>& painted);

/// What to do with vertices at exactly the same position.
enum class CoincidentVertices {
  kWeld,      ///< one region vertex for all: exporters that split vertices at UV seams would cut masks apart there
  kKeepApart  ///< as in the file: seams of equal positions are cuts
};

/// The region as a mesh of its own. Every region vertex is a corner of a region triangle.
struct RegionMesh {
  Eigen::MatrixX3d positions;        ///< #V by 3, in the unit of the mesh
  Eigen::MatrixX3i triangles;        ///< #T by 3, region vertices; degenerate ones are kept
  std::vector<int> mesh_vertices;    ///< #V: region vertex -> mesh vertex (the lowest of welded ones)
  std::vector<int> mesh_triangles;   ///< #T: region triangle -> mesh triangle, ascending
  std::vector<int> region_vertices;  ///< #mesh vertices: mesh vertex -> region vertex, -1 outside the region
  std::vector<int> components;       ///< #V: connected component of the vertex, 0 .. component_count - 1
  int component_count = 0;           ///< components are joined by shared vertices, counted by lowest vertex

  int vertexCount() const { return static_cast<int>(positions.rows()); }
  int triangleCount() const { return static_cast<int>(triangles.rows()); }
};

/// Cuts the region out of the mesh; region vertices keep the order of the mesh.
/// triangles  indices of rows of mesh.triangles, in any order; repetitions count once
/// Throws InputError if there are none, an index is out of range or a position is not finite.
RegionMesh extractRegion(const TriangleMesh& mesh, std::span<const int> triangles,
                         CoincidentVertices coincident = CoincidentVertices::kWeld);

}  // namespace facezip::geometry
