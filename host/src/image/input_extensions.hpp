// input_extensions.hpp - which files are images, by their names.
#pragma once

#include <filesystem>

namespace facezip::image {

/// Whether the extension, in any case, is one of the formats that facezip reads: PNG, and all that OpenImageIO knows.
/// OpenImageIO itself is not asked: it is loaded when such a file is opened, not for looking about in a folder.
bool hasImageExtension(const std::filesystem::path& file);

}  // namespace facezip::image
