// contact_sheet.hpp - a picture of what a package does to a capture.
#pragma once

#include <filesystem>

#include "facezip/capture.hpp"
#include "facezip/package.hpp"

namespace facezip::cli {

/// Writes a PNG with a row for each of a few expressions of the capture's first map: captured, decoded, and their
/// difference times 8 around grey; and a row with the neutral and the difference textures.
/// decoded  directory that reconstruct() wrote
void writeContactSheet(const std::filesystem::path& file, const Capture& capture, const Package& package,
                       const std::filesystem::path& decoded);

}  // namespace facezip::cli
