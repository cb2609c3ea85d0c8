// painted_image.hpp - images that people paint in the layout of the textures: regions, importance.
#pragma once

#include <filesystem>
#include <vector>

namespace facezip::compress {

/// How bright each texel is: its brightest colour channel, since people paint in any colour. Alpha is none.
struct PaintedImage {
  int width = 0;  ///< texels; any size, whatever the textures have
  int height = 0;
  std::vector<float> brightness;  ///< height x width, in [0, 1]; row 0 is v = 1

  float at(int x, int y) const;
};

/// Throws InputError where the image cannot be read.
PaintedImage readPaintedImage(const std::filesystem::path& file);

}  // namespace facezip::compress
