#include "face/importance.hpp"

#include <algorithm>

#include "facezip/error.hpp"

namespace facezip::compress {

Importance::Importance(const std::filesystem::path& file) : painted_(readPaintedImage(file)) {
  if (std::ranges::all_of(painted_.brightness, [](float brightness) { return brightness == 0.0f; })) {
    throw InputError({file.string(), "importance", "an image that is not black everywhere", "black texels only",
                      "paint white where errors matter"});
  }
}

float Importance::at(int x, int y, int width, int height) const {
  const auto nearest = [](int texel, int texels, int cells) {
    const double position = (texel + 0.5) * cells / texels;
    return std::clamp(static_cast<int>(position), 0, cells - 1);
  };
  const float brightness = painted_.at(nearest(x, width, painted_.width), nearest(y, height, painted_.height));
  return kLeast + (1.0f - kLeast) * brightness;
}

void Importance::apply(raster::TileMasks& tiles, int width, int height, int first_row) const {
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    for (int texel = 0; texel < raster::kTileTexels; ++texel) {
      float& weight = tiles.texel_weights[t * raster::kTileTexels + static_cast<std::size_t>(texel)];
      if (weight == 0.0f) continue;
      weight *= at(tiles.tiles[t].x * raster::kTileSide + texel % raster::kTileSide,
                   first_row + tiles.tiles[t].y * raster::kTileSide + texel / raster::kTileSide, width, height);
    }
  }
}

raster::TileMasks weighed(raster::TileMasks tiles, const std::optional<Importance>& importance,
                          const image::ImageShape& shape, int first_row) {
  if (importance) importance->apply(tiles, shape.width, shape.height, first_row);
  return tiles;
}

}  // namespace facezip::compress
