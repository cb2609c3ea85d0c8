// frame_writer.hpp - frames as image files, a band at a time.
#pragma once

#include <filesystem>
#include <functional>

#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "image/image_file.hpp"

namespace facezip::blend {

/// Writes a frame of `map` as writeFrame() does, by a function that writes all its rows. Throws what it throws.
/// progress  may be null
void writeFrameBy(const std::filesystem::path& file, const PackageMap& map, Progress* progress,
                  const std::function<void(image::ImageWriter& writer)>& write);

}  // namespace facezip::blend
