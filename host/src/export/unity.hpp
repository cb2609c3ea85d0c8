// unity.hpp - a face as a folder of Unity's Assets.
#pragma once

#include <filesystem>

#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip::exporting {

/// Writes all but scene.gltf and the embedded scripts into `folder`. Throws InputError, OutputError, Cancelled.
void writeUnity(const Package& package, const std::filesystem::path& folder, Progress& progress);

}  // namespace facezip::exporting
