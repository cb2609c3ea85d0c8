// mesh_edges.hpp - edges, borders and normals of a triangle mesh.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace facezip::geometry {

/// Unit normals of the triangles, #T by 3; zero where there is no area.
Eigen::MatrixX3d triangleNormals(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles);

/// Unit normals of the vertices, weighted by the area of the triangles around them, #V by 3; zero where there are none.
Eigen::MatrixX3d vertexNormals(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles);

/// Edges of one used triangle alone: #T, bit k is set where that is the edge opposite corner k.
/// used  #T; triangles that are not have no borders and make none
std::vector<unsigned char> borderEdges(const Eigen::MatrixX3i& triangles, const std::vector<bool>& used);

/// The edges of a mesh, each once however many triangles share it, the lower vertex first, in rising order.
std::vector<std::array<int, 2>> meshEdges(const Eigen::MatrixX3i& triangles);

/// Area of a triangle.
double triangleArea(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, Eigen::Index t);

/// A third of the area of the triangles around every vertex, #V, in the square of the unit.
Eigen::VectorXd vertexAreas(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles);

}  // namespace facezip::geometry
