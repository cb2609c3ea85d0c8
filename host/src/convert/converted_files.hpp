// converted_files.hpp - the files of a converted package.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "convert/map_conversion.hpp"

namespace facezip::convert {

/// Writes the package into an empty directory with all textures as images: what blocks decode to, in whole codes.
/// Throws InputError, OutputError, Cancelled.
void writeAsImages(const Package& package, const std::filesystem::path& directory, Progress& progress);

/// Writes the whole package into an empty directory.
/// sets  of every set of weights what was converted
/// Throws InputError, OutputError, DeviceError, Cancelled.
void writeConverted(const Package& package, std::span<const std::unique_ptr<ConvertedSet>> sets,
                    const std::filesystem::path& directory, const device::Run& run);

}  // namespace facezip::convert
