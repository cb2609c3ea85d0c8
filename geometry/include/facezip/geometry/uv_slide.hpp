// uv_slide.hpp - vertices moved over the surface, by vectors in the texture plane.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::geometry {

/// The connected part of the layout that each triangle is of, from 0: triangles that share a UV.
std::vector<int> uvIslands(const TriangleMesh& mesh);

/// Moves each vertex to the point of the mesh's own surface that has the UV of the vertex plus a vector. Vertices on
/// seams, which have several UVs, move to the mean of where these lead. Where a vector leaves the island it is
/// shortened.
/// vectors  #UV by 2, of each of mesh.uvs
/// Returns positions, #V by 3.
Eigen::MatrixX3d slideAlongUvs(const TriangleMesh& mesh, const Eigen::MatrixX2d& vectors);

}  // namespace facezip::geometry
