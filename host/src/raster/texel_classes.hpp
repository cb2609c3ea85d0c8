// texel_classes.hpp - which texels of an image show the region and which are its gutter, known to all passes at once.
// The gutter of a band reaches for covered texels far into the rows beside it: bands of few rows, as wide images have
// them, would raster most rows several times in every pass.
#pragma once

#include <cstdint>
#include <vector>

#include "io/counts.hpp"
#include "raster/tiles.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::raster {

/// Two bits for each texel of a raster, and a byte where it has a feather.
class TexelClasses {
 public:
  /// Of an image that shows nothing yet.
  TexelClasses(int width, int height);
  /// Of the whole image.
  explicit TexelClasses(const UvRaster& raster);
  /// Of rows [begin, end) as a whole of their own, without the gutter.
  static TexelClasses coveredRows(const UvRaster& raster, int begin, int end);

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t bytes() const { return words_.size() * sizeof(std::uint32_t) + fades_.size(); }

  /// Texels of row y that column `tile_x` of tiles holds, the leftmost in the lowest bit: covered, gutter or
  /// feather.
  std::uint32_t active(int tile_x, int y) const { return words_[index(tile_x, y)] & 0xffffu; }
  /// The same, covered alone.
  std::uint32_t covered(int tile_x, int y) const { return words_[index(tile_x, y)] >> 16; }

  /// Whether there is a feather, and the share of the differences of texel (x, y) that counts, in 1/255.
  bool fades() const { return !fades_.empty(); }
  std::uint8_t fade(int x, int y) const { return fades_[toSize(y, width_) + toSize(x)]; }
  /// Marks texels of row y in column `tile_x` of tiles, the leftmost in the lowest bit; those that are covered are
  /// active, too. Rows may be marked side by side.
  void mark(int tile_x, int y, std::uint32_t active, std::uint32_t covered) {
    words_[index(tile_x, y)] |= (active | covered) | covered << 16;
  }

 private:
  /// Takes over whole rows of samples, the first as row `y`.
  void set(const std::vector<TexelSample>& samples, int y);
  std::size_t index(int tile_x, int y) const { return toSize(y, tile_columns_) + toSize(tile_x); }

  int width_;
  int height_;
  int tile_columns_;
  std::vector<std::uint32_t> words_;  ///< [row][tile column]: active, then covered << 16
  std::vector<std::uint8_t> fades_;   ///< [row][column]; empty without a feather
};

}  // namespace facezip::raster
