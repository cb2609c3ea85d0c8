// averaged_image.hpp - an image at a fraction of its size.
#pragma once

#include <filesystem>

#include "image/image_file.hpp"

namespace facezip::image {

/// The image with every `factor` by `factor` texels averaged to one; those at the right and below may be fewer.
/// Alpha and what else is beyond one or three channels is left out. Throws InputError.
Image readAveraged(const std::filesystem::path& file, int factor);

}  // namespace facezip::image
