#include "raster/texel_classes.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "io/counts.hpp"

namespace facezip::raster {

static_assert(kTileSide == 16, "a row of a tile is half a word");

TexelClasses::TexelClasses(int width, int height)
    : width_(width), height_(height), tile_columns_(tilesAlong(width)), words_(toSize(tile_columns_, height), 0) {}

TexelClasses::TexelClasses(const UvRaster& raster) : TexelClasses(raster.width(), raster.height()) {
  if (raster.feather() > 0) fades_.resize(toSize(width_, height_), 255);
  // Few enough rows for little memory, enough that the gutter above and below them costs no more than they do.
  const int rows_at_once = std::max(64, 2 * raster.reach());
  for (int begin = 0; begin < height_; begin += rows_at_once) {
    set(raster.rows(begin, std::min(begin + rows_at_once, height_)), begin);
  }
}

TexelClasses TexelClasses::coveredRows(const UvRaster& raster, int begin, int end) {
  TexelClasses classes(raster.width(), end - begin);
  classes.set(raster.coveredRows(begin, end), 0);
  return classes;
}

void TexelClasses::set(const std::vector<TexelSample>& samples, int y) {
  const auto width = toSize(width_);
  tbb::parallel_for(std::size_t{0}, samples.size() / width, [&](std::size_t row) {
    const TexelSample* texels = samples.data() + row * width;
    for (int x = 0; x < width_; ++x) {
      if (texels[x].triangle < 0) continue;
      const std::uint32_t bits = texels[x].kind == TexelSample::Kind::kCovered ? 0x10001u : 1u;
      words_[index(x / kTileSide, y + static_cast<int>(row))] |= bits << (x % kTileSide);
      if (!fades_.empty()) fades_[toSize(y + static_cast<int>(row), width_) + toSize(x)] = texels[x].fade;
    }
  });
}

}  // namespace facezip::raster
