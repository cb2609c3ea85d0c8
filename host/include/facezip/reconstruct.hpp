// reconstruct.hpp - the textures of single expressions, back from a package (FaceZip, Eq. 1).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "facezip/device.hpp"
#include "facezip/memory.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// Writes OUTPUT/MAP/NAME.png (.exr for float maps) for every map and every named expression: what Blender gives for
/// that expression's weight 1 and all others 0, in the type and size of the map's neutral. Rows stream through in
/// bands, so memory does not grow with the height of the images. The files appear in `output` when all of them are
/// complete; other files there stay.
/// expressions   names of the package; empty means all
/// memory_bytes  what the process may keep resident, host and device together
/// Throws InputError for unknown or repeated names, damaged images and a package whose weights alone need more memory;
/// OutputError, DeviceError, Cancelled.
void reconstruct(const Package& package, const std::filesystem::path& output, std::span<const std::string> expressions,
                 const Device& device, Progress& progress, std::uint64_t memory_bytes = kDefaultMemoryBytes);

}  // namespace facezip
