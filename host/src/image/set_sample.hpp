// set_sample.hpp - one sample of an image in memory, written.
#pragma once

#include <cstddef>

#include "image/image_file.hpp"

namespace facezip::image {

/// Writes a sample, 1 at full scale; of integers the nearest within their range. The other way about: sampleAt().
/// index  into the samples, not the bytes
void setSample(Image& image, std::size_t index, float value);

}  // namespace facezip::image
