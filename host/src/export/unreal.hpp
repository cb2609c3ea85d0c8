// unreal.hpp - a face as a folder that a script of Unreal's editor imports.
#pragma once

#include <filesystem>

#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip::exporting {

/// Writes all but scene.gltf and the embedded script into `folder`. Throws InputError, OutputError, Cancelled.
void writeUnreal(const Package& package, const std::filesystem::path& folder, Progress& progress);

}  // namespace facezip::exporting
