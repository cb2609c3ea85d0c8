// glb_scene.hpp - a binary glTF file of strangers, and the meshes of its scene.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "io/json_field.hpp"
#include "scene/scene_mesh.hpp"

namespace facezip::scene {

/// A .glb file, taken apart. Nothing beside it is ever read.
class GlbFile {
 public:
  /// what  "a scan", for messages. Throws InputError: no whole glTF 2.0, extensionsRequired, a buffer elsewhere.
  GlbFile(const std::filesystem::path& file, const char* what);
  GlbFile(const GlbFile&) = delete;  // its parts refer to its bytes
  GlbFile& operator=(const GlbFile&) = delete;

  io::JsonField root() const;
  std::span<const std::byte> binary() const { return binary_; }
  /// Elements of the array; none where there is no such member.
  std::vector<io::JsonField> members(const char* key) const;

 private:
  std::string name_;
  std::string bytes_;
  nlohmann::json document_;
  std::span<const std::byte> binary_;
};

/// What a field that is an index refers to. Throws InputError.
const io::JsonField& referredBy(const io::JsonField& reference, const std::vector<io::JsonField>& among);

/// The triangles of the scene's meshes, one for each node that has one, with TEXCOORD_0 and morph targets of positions.
/// Throws InputError naming the field: anything out of range, a primitive that is no triangles, a graph of nodes that
/// is no tree, no mesh.
std::vector<SceneMesh> meshesOf(const GlbFile& file);

}  // namespace facezip::scene
