// exr_header.hpp - the attributes at the head of an EXR file, looked over before OpenEXR reads them: it takes as much
// memory as an attribute says that it has, whatever the file holds.
#pragma once

#include <filesystem>

#include "facezip/input_file.hpp"

namespace facezip::image {

/// Throws InputError where there are several images, the attributes of the one do not end within the
/// file's first MiB, or it has more channels or a larger side than packages, or DWA's blocks of 256 rows.
/// path  for messages
void requireExrHeader(const InputFile& file, const std::filesystem::path& path);

}  // namespace facezip::image
