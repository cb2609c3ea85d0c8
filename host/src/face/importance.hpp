// importance.hpp - a painted image of where errors matter more: the texel weights of every sum.
#pragma once

#include <filesystem>
#include <optional>

#include "face/painted_image.hpp"
#include "image/image_file.hpp"
#include "raster/tiles.hpp"

namespace facezip::compress {

/// White texels count fully, black ones a hundredth (no texel may be lost altogether, or its weights would run wild).
class Importance {
 public:
  static constexpr float kLeast = 0.01f;

  /// Reads a painted image (face/painted_image.hpp). Throws InputError: unreadable, or black everywhere.
  explicit Importance(const std::filesystem::path& file);

  /// Weight at the centre of texel (x, y) of a texture of width x height, in [kLeast, 1]: the nearest texel's.
  float at(int x, int y, int width, int height) const;

  /// Multiplies the texel weights of tiles of a texture of width x height; first_row: the image row where they begin.
  void apply(raster::TileMasks& tiles, int width, int height, int first_row) const;

 private:
  PaintedImage painted_;
};

/// Tiles of a texture of `shape` with the importance in their texel weights, where there is one.
raster::TileMasks weighed(raster::TileMasks tiles, const std::optional<Importance>& importance,
                          const image::ImageShape& shape, int first_row);

}  // namespace facezip::compress
