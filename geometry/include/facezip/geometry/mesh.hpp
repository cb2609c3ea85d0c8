// mesh.hpp - an indexed triangle mesh with texture coordinates.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace facezip::geometry {

/// A triangle mesh as it is read from disk: vertex order kept, polygons split into triangle fans.
struct TriangleMesh {
  Eigen::MatrixX3d positions;     ///< #V by 3, in the unit of the file
  Eigen::MatrixX2d uvs;           ///< #UV by 2, v up (row 0 of an image is v = 1); 0 rows when the file has none
  Eigen::MatrixX3i triangles;     ///< #T by 3, indices into positions
  Eigen::MatrixX3i uv_triangles;  ///< #T by 3, indices into uvs, row by row with triangles; 0 rows without uvs
  std::vector<int> polygons;      ///< #T: which face of the file a triangle is part of, rising; empty: each is its own
};

}  // namespace facezip::geometry
