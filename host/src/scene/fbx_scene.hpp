// fbx_scene.hpp - the meshes of an FBX file, through assimp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene_mesh.hpp"

namespace facezip::scene {

/// The meshes of an FBX file, one for each node that has one and each material of it, with their first UVs and their
/// blend shapes. Units and axes are those of the file. What else it names is not read.
/// Throws InputError: no regular file, one of more than 1 GiB, one that assimp does not take, no mesh.
std::vector<SceneMesh> readFbx(const std::filesystem::path& file);

/// What the module exports; the library facezip holds it itself. bytes  of the file; name  for messages
using FbxFunction = std::vector<SceneMesh> (*)(const std::string& bytes, const std::string& name);
extern "C" __attribute__((visibility("default"))) FbxFunction facezipAssimpFbx();
inline constexpr const char* kAssimpFbxEntry = "facezipAssimpFbx";

}  // namespace facezip::scene
