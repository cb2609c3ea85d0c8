// textured_obj.hpp - Wavefront OBJ files with the textures of their materials.
#pragma once

#include <filesystem>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::geometry {

/// A mesh and the colour textures that its materials name.
struct TexturedMesh {
  TriangleMesh mesh;
  std::vector<int> materials;                   ///< #T, index into textures
  std::vector<std::filesystem::path> textures;  ///< of each material, in the mesh's folder; empty where it has none
};

/// Reads a mesh as readObj() does, and the material libraries (MTL) that it names: `map_Kd` of each material. Faces
/// without a material have the last entry of `textures`, which is empty. Libraries and textures are looked for in the
/// folder of the OBJ file and below, whatever path is written; what is missing there counts as not named.
/// Throws InputError as readObj().
TexturedMesh readTexturedObj(const std::filesystem::path& file);

}  // namespace facezip::geometry
