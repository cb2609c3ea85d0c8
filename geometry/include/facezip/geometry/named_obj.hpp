// named_obj.hpp - Wavefront OBJ files with the names of their parts and what their materials say.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::geometry {

/// What a material library says of a material.
struct ObjMaterial {
  std::array<double, 3> colour = {1, 1, 1};  ///< Kd, 0 to 1
  double opacity = 1.0;                      ///< d, 0 to 1
  std::filesystem::path texture;             ///< map_Kd, in the mesh's folder; empty where there is none
};

/// A mesh whose faces have names: of their material (`usemtl`), or, in a file without materials, of their object or
/// group (`o`, `g`).
struct NamedMesh {
  TriangleMesh mesh;
  std::vector<std::string> names;                     ///< each once, in the order of the file; "" for faces without
  std::vector<int> of_triangle;                       ///< #T, index into names
  std::vector<std::optional<ObjMaterial>> materials;  ///< of each name; none where no library has it
};

/// Reads a mesh as readObj() does, and the material libraries that it names, as readTexturedObj() does.
/// Throws InputError as readObj().
NamedMesh readNamedObj(const std::filesystem::path& file);

}  // namespace facezip::geometry
