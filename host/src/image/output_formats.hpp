// output_formats.hpp - the image files that can be written. OpenImageIO writes more, but takes what comes nearest where
// a format cannot hold what it is given, without a word.
#pragma once

#include <filesystem>

#include "image/image_file.hpp"

namespace facezip::image {

/// Throws InputError where files of that name are none that facezip writes, or could not hold such an image: floats in
/// a PNG, two channels in a JPEG. What passes is stored as it is, but by JPEG, which rounds.
void requireFormat(const std::filesystem::path& file, const ImageShape& shape);

}  // namespace facezip::image
