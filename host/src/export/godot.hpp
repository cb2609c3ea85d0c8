// godot.hpp - a face as a project of Godot 3: textures that it imports as arrays, a shader, a material and a scene.
#pragma once

#include <filesystem>

#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip::exporting {

/// Writes all but scene.gltf and the embedded scripts into `folder`. Throws InputError, OutputError, Cancelled.
void writeGodot(const Package& package, const std::filesystem::path& folder, Progress& progress);

}  // namespace facezip::exporting
