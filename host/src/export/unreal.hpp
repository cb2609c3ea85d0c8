// unreal.hpp - a face as a folder that a script of Unreal's editor imports.
#pragma once

#include <filesystem>

#include "facezip/package.hpp"

namespace facezip::exporting {

/// Writes all but scene.gltf and the embedded script into `folder`. Throws InputError, OutputError.
void writeUnreal(const Package& package, const std::filesystem::path& folder);

}  // namespace facezip::exporting
