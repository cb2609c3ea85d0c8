#include "compress/importance.hpp"

#include <algorithm>

#include "facezip/error.hpp"
#include "image/image_file.hpp"

namespace facezip::compress {
Importance::Importance(const std::filesystem::path& file) {
  const image::Image image = image::readImage(file);
  width_ = image.shape.width;
  height_ = image.shape.height;
  const auto channels = static_cast<std::size_t>(image.shape.channels);
  values_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  bool any = false;
  for (std::size_t texel = 0; texel < values_.size(); ++texel) {
    float sum = 0.0f;
    for (std::size_t c = 0; c < channels; ++c) sum += image::sampleAt(image, texel * channels + c);
    const float mean = sum / static_cast<float>(channels);
    any = any || mean > 0.0f;
    values_[texel] = kLeast + (1.0f - kLeast) * std::clamp(mean, 0.0f, 1.0f);
  }
  if (!any) {
    throw InputError({file.string(), "importance", "an image that is not black everywhere", "black texels only",
                      "paint white where errors matter"});
  }
}

float Importance::at(int x, int y, int width, int height) const {
  const auto nearest = [](int texel, int texels, int cells) {
    const double position = (texel + 0.5) * cells / texels;
    return static_cast<std::size_t>(std::clamp(static_cast<int>(position), 0, cells - 1));
  };
  return values_[nearest(y, height, height_) * static_cast<std::size_t>(width_) + nearest(x, width, width_)];
}

void Importance::apply(TileMasks& tiles, int width, int height, int first_row) const {
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    for (int texel = 0; texel < kTileTexels; ++texel) {
      float& weight = tiles.texel_weights[t * kTileTexels + static_cast<std::size_t>(texel)];
      if (weight == 0.0f) continue;
      weight *= at(tiles.tiles[t].x * kTileSide + texel % kTileSide,
                   first_row + tiles.tiles[t].y * kTileSide + texel / kTileSide, width, height);
    }
  }
}

TileMasks weighed(TileMasks tiles, const std::optional<Importance>& importance, const image::ImageShape& shape,
                  int first_row) {
  if (importance) importance->apply(tiles, shape.width, shape.height, first_row);
  return tiles;
}

}  // namespace facezip::compress
