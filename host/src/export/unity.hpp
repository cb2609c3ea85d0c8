// unity.hpp - a face as a folder of Unity's Assets.
#pragma once

#include <filesystem>
#include <optional>

#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip::exporting {

/// Formats of which Unity makes textures of raw blocks: of ASTC the square ones, of BC where sides are multiples of 4.
std::optional<BlockFormat> unityBlocks(const PackageMap& map, int texture);

/// Writes all but scene.gltf and the embedded scripts into `folder`. Throws InputError, OutputError, Cancelled.
void writeUnity(const Package& package, const std::filesystem::path& folder, Progress& progress);

}  // namespace facezip::exporting
