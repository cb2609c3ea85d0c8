// importance.hpp - a painted image of where errors matter more: the texel weights of every sum.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "compress/bands/tile_band.hpp"

namespace facezip::compress {

/// White texels count fully, black ones a hundredth (no texel may be lost altogether, or its weights would run wild).
class Importance {
 public:
  static constexpr float kLeast = 0.01f;

  /// Reads an image of any size in the layout of the textures; its channels' mean counts, alpha too. Throws InputError:
  /// unreadable, or black everywhere.
  explicit Importance(const std::filesystem::path& file);

  /// Weight at the centre of texel (x, y) of a texture of width x height, in [kLeast, 1]: the nearest texel's.
  float at(int x, int y, int width, int height) const;

  /// Multiplies the texel weights of tiles of a texture of width x height; first_row: the image row where they begin.
  void apply(TileMasks& tiles, int width, int height, int first_row) const;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<float> values_;  ///< width_ x height_
};

/// Tiles of a texture of `shape` with the importance in their texel weights, where there is one.
TileMasks weighed(TileMasks tiles, const std::optional<Importance>& importance, const image::ImageShape& shape,
                  int first_row);

}  // namespace facezip::compress
