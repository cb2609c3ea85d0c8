// template_textures.hpp - what a template's textures do in its shapes, put on a subject.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/progress.hpp"

namespace facezip::rig {

/// The subject's maps with an image for each of `shapes`: the neutral's plus what the template's texture of that shape
/// (MAP/SHAPE.png) differs by from the template's neutral (MAP/neutral.png), resampled to the subject's size. Where the
/// template has no such texture the shape's is the neutral's own file.
/// folder  a scratch folder for the images
/// Throws InputError where the template's textures cannot be read or their channels are others than the subject's.
std::vector<CaptureMap> transferTextures(const std::vector<CaptureMap>& subject,
                                         const std::filesystem::path& template_directory,
                                         const std::vector<std::string>& shapes, const std::filesystem::path& folder,
                                         Progress& progress);

}  // namespace facezip::rig
