// unity.hpp - a face as a folder of Unity's Assets.
#pragma once

#include <filesystem>

#include "facezip/package.hpp"

namespace facezip::exporting {

/// Writes all but scene.gltf and the embedded scripts into `folder`. Throws InputError, OutputError.
void writeUnity(const Package& package, const std::filesystem::path& folder);

}  // namespace facezip::exporting
