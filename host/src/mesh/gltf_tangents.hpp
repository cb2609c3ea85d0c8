// gltf_tangents.hpp - tangents for normal maps, of the mesh at rest and of its morph targets.
#pragma once

// A system header: its own warnings are not ours.
#include <tiny_gltf.h>

namespace facezip::mesh {

/// Gives the primitives of a model TANGENT, and their targets what they change of it, where they have normals and
/// UVs and no tangents yet. Readers make up what is missing, for every vertex of its own, and some lose the targets'
/// order by that. Tangents are those of glTF: along rising u, orthogonal to the normal, w the side of the bitangent,
/// which runs against v. Each triangle counts by its angle at the vertex, as MikkTSpace has it.
void addTangents(tinygltf::Model& model);

}  // namespace facezip::mesh
