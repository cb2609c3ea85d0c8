// contact_sheet.hpp - a picture of what a package does to a capture.
#pragma once

#include <filesystem>

#include "facezip/capture.hpp"
#include "facezip/package.hpp"

namespace facezip::cli {

/// Writes a PNG: a row with the neutral and the difference textures of the capture's first map, then a few expressions
/// as captured, as decoded, and their difference times 8 around grey. decoded  directory that reconstruct() wrote
void writeContactSheet(const std::filesystem::path& file, const Capture& capture, const Package& package,
                       const std::filesystem::path& decoded);

}  // namespace facezip::cli
