// topology.hpp - do the meshes of a capture belong together?
#pragma once

#include <span>
#include <string>

#include "facezip/geometry/mesh.hpp"

namespace facezip::geometry {

/// Checks that an expression is the neutral, moved: the same number of vertices, the same faces in the same order, each
/// beginning at any of its corners, and, where the expression's file has any, the same UVs at the corners of the faces
/// (to 1.1e-4, four decimals), however the file lists them.
/// neutral_file, expression_file  for messages
/// Throws InputError naming the first difference.
void requireSameTopology(const TriangleMesh& neutral, const std::string& neutral_file, const TriangleMesh& expression,
                         const std::string& expression_file);

/// Checks that the mesh has UVs and that those its triangles use lie in [0,1] (to 1.1e-4).
/// Throws InputError naming the first UV outside, as the file counts them (from 1), and its value.
void requireUvs(const TriangleMesh& mesh, const std::string& file);

/// The same for the UVs of some triangles only: of a head whose neck lies in another UDIM tile, say.
/// triangles  indices of rows of mesh.triangles
void requireUvs(const TriangleMesh& mesh, const std::string& file, std::span<const int> triangles);

}  // namespace facezip::geometry
