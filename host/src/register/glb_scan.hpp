// glb_scan.hpp - a scan in one binary glTF file, its textures inside.
#pragma once

#include <filesystem>
#include <memory>

#include "facezip/geometry/textured_mesh.hpp"
#include "io/scratch_directory.hpp"
#include "scene/scene_mesh.hpp"

namespace facezip::registration {

/// The triangles of all meshes where the nodes of the scene place them, with TEXCOORD_0 (v up, as everywhere here) and
/// the base colour texture of their materials.
struct GlbScan {
  geometry::TexturedMesh textured;                 ///< a material of the file each; the last texture is of none, empty
  std::unique_ptr<io::ScratchDirectory> pictures;  ///< the textures, as files; null where there are none
};

/// All meshes of a scene as one, with their materials and no textures. Throws InputError where one has no UVs.
geometry::TexturedMesh joinedMeshes(const std::vector<scene::SceneMesh>& meshes, const std::filesystem::path& file);

/// Reads a .glb file of strangers: every range is checked, nothing beside the file is read. What compresses meshes
/// (extensionsRequired) is refused, and so are images that are not in the file.
/// Throws InputError naming the field; OutputError where textures cannot be put down.
GlbScan readGlbScan(const std::filesystem::path& file);

}  // namespace facezip::registration
