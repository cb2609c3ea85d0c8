// float_image.hpp - whole images as floats, and differences of one size added to an image of another.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "image/image_file.hpp"

namespace facezip::image {

/// Samples in 1/255 of full scale, [height][width][channels].
struct FloatImage {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> samples;

  FloatImage() = default;
  FloatImage(int w, int h, int c);
  bool isLike(const FloatImage& other) const {
    return width == other.width && height == other.height && channels == other.channels;
  }
  /// "1024 x 1024, 3 channels"
  std::string sizeText() const;
};

/// Throws InputError as ImageReader does.
FloatImage readFloatImage(const std::filesystem::path& path);

/// Reads an image and resamples it while its rows come in: memory is that of the result. Shrinks by averaging whole
/// texels' areas, enlarges bilinearly; edges repeat. Texel centres are at half integers in both.
FloatImage readResized(const std::filesystem::path& path, int width, int height);

/// An extension whose format holds the samples of `path` exactly: ".png", or ".exr" for floats.
std::string losslessExtension(const std::filesystem::path& path);

/// Writes `neutral` plus a change, clamped to the range of whole numbers, in bands of rows.
/// change  resampled to the neutral's size; as many channels
/// Throws InputError where channels differ or the neutral cannot be read, OutputError.
void writeChanged(const std::filesystem::path& neutral, const FloatImage& change, const std::filesystem::path& output);

}  // namespace facezip::image
