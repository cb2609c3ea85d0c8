#include "face/painted_image.hpp"

#include <algorithm>

#include "image/image_file.hpp"
#include "io/counts.hpp"

namespace facezip::compress {

float PaintedImage::at(int x, int y) const { return brightness[toSize(y) * toSize(width) + toSize(x)]; }

PaintedImage readPaintedImage(const std::filesystem::path& file) {
  const image::Image image = image::readImage(file);
  PaintedImage painted{image.shape.width, image.shape.height, {}};
  const std::size_t channels = toSize(image.shape.channels);
  const std::size_t colours = channels == 2 || channels == 4 ? channels - 1 : channels;
  painted.brightness.reserve(toSize(painted.width, painted.height));
  for (std::size_t texel = 0; texel < toSize(painted.width, painted.height); ++texel) {
    float brightest = 0.0f;
    for (std::size_t c = 0; c < colours; ++c) {
      brightest = std::max(brightest, image::sampleAt(image, texel * channels + c));
    }
    painted.brightness.push_back(std::min(brightest, 1.0f));
  }
  return painted;
}

}  // namespace facezip::compress
