// test_meshes.hpp - small meshes with the awkward parts that real ones have.
#pragma once

#include <cmath>
#include <vector>

#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/mesh.hpp"

namespace facezip::test {

/// A wavy sheet of columns by rows vertices with UVs, open at its boundary; no two distances alike.
inline geometry::TriangleMesh makeSheet(int columns, int rows) {
  geometry::TriangleMesh mesh;
  mesh.positions.resize(columns * rows, 3);
  mesh.uvs.resize(columns * rows, 2);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const int v = y * columns + x;
      mesh.positions.row(v) << x + 0.1 * std::sin(1.7 * y + 0.3 * x), 1.1 * y + 0.1 * std::cos(2.3 * x),
          std::sin(0.4 * x) + std::cos(0.3 * y);
      mesh.uvs.row(v) << (x + 0.5) / columns, (y + 0.5) / rows;
    }
  }
  mesh.triangles.resize(2 * (columns - 1) * (rows - 1), 3);
  int t = 0;
  for (int y = 0; y + 1 < rows; ++y) {
    for (int x = 0; x + 1 < columns; ++x) {
      const int v = y * columns + x;
      mesh.triangles.row(t++) << v, v + 1, v + columns + 1;
      mesh.triangles.row(t++) << v, v + columns + 1, v + columns;
    }
  }
  mesh.uv_triangles = mesh.triangles;
  return mesh;
}

/// Both meshes in one, `b` moved by `offset`.
inline geometry::TriangleMesh join(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b,
                                   const Eigen::RowVector3d& offset) {
  geometry::TriangleMesh mesh;
  mesh.positions.resize(a.positions.rows() + b.positions.rows(), 3);
  mesh.positions << a.positions, b.positions.rowwise() + offset;
  mesh.uvs.resize(a.uvs.rows() + b.uvs.rows(), 2);
  mesh.uvs << a.uvs, b.uvs;
  const auto moved = [](const Eigen::MatrixX3i& triangles, Eigen::Index by) {
    return (triangles.array() + static_cast<int>(by)).matrix().eval();
  };
  mesh.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
  mesh.triangles << a.triangles, moved(b.triangles, a.positions.rows());
  mesh.uv_triangles.resize(mesh.triangles.rows(), 3);
  mesh.uv_triangles << a.uv_triangles, moved(b.uv_triangles, a.uvs.rows());
  return mesh;
}

/// Adds a row to the triangles, with UVs at the first texture coordinate.
inline void addTriangle(geometry::TriangleMesh& mesh, int a, int b, int c) {
  const Eigen::Index row = mesh.triangles.rows();
  mesh.triangles.conservativeResize(row + 1, 3);
  mesh.triangles.row(row) << a, b, c;
  mesh.uv_triangles.conservativeResize(row + 1, 3);
  mesh.uv_triangles.row(row).setZero();
}

/// A sheet with a vertex that no triangle uses, a triangle of no area, two with a repeated corner (one joins the two
/// last vertices of the sheet to nothing new, one is a single lone vertex) and an edge with three triangles.
inline geometry::TriangleMesh makeDamagedSheet() {
  geometry::TriangleMesh mesh = makeSheet(7, 6);
  const auto count = static_cast<int>(mesh.positions.rows());
  mesh.positions.conservativeResize(count + 3, 3);
  mesh.positions.row(count) << 100, 200, 300;      // unused
  mesh.positions.row(count + 1) << 3, 3, 9;        // tip of the fin
  mesh.positions.row(count + 2) << -20, -20, -20;  // alone
  addTriangle(mesh, 0, 1, 2);                      // nearly flat, over existing edges and a new one
  addTriangle(mesh, count - 1, count - 1, count - 2);
  addTriangle(mesh, count + 2, count + 2, count + 2);
  addTriangle(mesh, 8, 9, count + 1);  // third triangle of edge 8 9
  return mesh;
}

inline geometry::RegionMesh wholeRegion(const geometry::TriangleMesh& mesh) {
  return geometry::extractRegion(mesh, geometry::wholeMeshRegion(mesh));
}

}  // namespace facezip::test
