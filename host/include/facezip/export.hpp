// export.hpp - a package as other tools take it: a mesh with morph targets, plain textures, and the blend.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "facezip/memory.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// Names of the targets: "blender", "gltf", "godot", "three", "unity", "unreal".
std::vector<std::string> exportTargets();

/// Writes a folder: `scene.gltf` with `scene.bin` (the mesh with morph targets), `package` (a copy) or `textures` as
/// engines take them, the blend in the target's language, and README.md for the person who drops it in: docs/export.md.
/// It appears whole or not at all; a folder that was exported before is replaced. Throws InputError for an unknown
/// target, a package without a mesh, and, of engines, one with maps of floats alone; OutputError, Cancelled.
/// memory_bytes  what the process may keep resident. Textures pass in rows; a mesh that needs more is refused
/// Returns what of the package the target does not get, a sentence each.
std::vector<std::string> exportPackage(const Package& package, const std::string& target,
                                       const std::filesystem::path& output, Progress& progress,
                                       std::uint64_t memory_bytes = kDefaultMemoryBytes);

}  // namespace facezip
