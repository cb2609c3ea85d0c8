// export.hpp - a package as other tools take it: a mesh with morph targets, plain textures, and the blend.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "facezip/package.hpp"

namespace facezip {

/// Names of the targets: "gltf", "three", "blender".
std::vector<std::string> exportTargets();

/// Writes a folder: `scene.gltf` with `scene.bin` (the mesh with morph targets, the neutral textures as material, the
/// blend as extras), `package` (a copy), the target's script, and README.md for the person who drops it in. It appears
/// whole or not at all; a folder that was exported before is replaced. Throws InputError for an unknown target and a
/// package without a mesh; OutputError.
void exportPackage(const Package& package, const std::string& target, const std::filesystem::path& output);

}  // namespace facezip
