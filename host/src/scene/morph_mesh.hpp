// morph_mesh.hpp - a neutral and its expressions as morph targets of one mesh, in a GLB or FBX file.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "facezip/geometry/mesh.hpp"

namespace facezip::scene {

/// By its extension, .glb or .fbx in any case.
bool isSceneFile(const std::filesystem::path& file);

/// The one file of that kind in a directory; empty if there is none. cure  where there are several, which is refused
std::filesystem::path sceneFileIn(const std::filesystem::path& directory, const std::string& cure);

struct MorphMesh {
  std::string name;                                   ///< of the mesh in its file
  geometry::TriangleMesh neutral;                     ///< vertices and UVs that files split at seams are one again
  std::map<std::string, Eigen::MatrixX3d> positions;  ///< of each morph target, #V by 3
  std::string note;                                   ///< what was left out; "" for nothing
};

/// Reads the mesh of that name; "": the one that has morph targets, of several the one of the most triangles. Names of
/// targets are composed (io/composed.hpp), and what all of them begin with up to a `.`, `:`, `|` or `__` is left out
/// ("blendShape1.jawOpen", "head_lod0_mesh__jawOpen").
/// Throws InputError: those of meshesOf() and readFbx(), no mesh of that name, no UVs, targets without names or with
/// the same one.
MorphMesh readMorphMesh(const std::filesystem::path& file, const std::string& name);

}  // namespace facezip::scene
