// textured_mesh.hpp - meshes with what they look like: textures of their materials, colours of their vertices.
#pragma once

#include <filesystem>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::geometry {

/// A mesh, the colour textures that it names, and the colours of its vertices.
struct TexturedMesh {
  TriangleMesh mesh;
  std::vector<int> materials;                   ///< #T, index into textures
  std::vector<std::filesystem::path> textures;  ///< of each material, in the mesh's folder; empty where it has none
  Eigen::MatrixX3f colours;                     ///< #V by 3, red, green, blue in 0..1; 0 rows where there are none
};

/// Reads a mesh as readObj() does, and the material libraries (MTL) that it names: `map_Kd` of each material. Faces
/// without a material have the last entry of `textures`, which is empty. Colours are numbers behind all positions.
/// Libraries and textures are looked for in the folder of the OBJ file and below, whatever path is written; what is
/// missing there counts as not named. Throws InputError as readObj().
TexturedMesh readTexturedObj(const std::filesystem::path& file);

/// Reads a PLY file, ASCII or binary: positions, faces (polygons become fans, as in readObj()), colours of vertices,
/// UVs of faces (`texcoord`) or of vertices (`s`, `t` and their other names), textures that `comment TextureFile` names,
/// of which `texnumber` tells a face's. The last entry of `textures` is of faces without one, and empty.
/// Throws InputError naming the element: no regular file, one of more than 2 GiB; no vertices or no faces; an end before
/// the last element; numbers that are none; lists that are counted by 32 bits; an index out of range; UVs of some faces
/// alone.
TexturedMesh readTexturedPly(const std::filesystem::path& file);

}  // namespace facezip::geometry
