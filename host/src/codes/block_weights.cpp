#include "codes/block_weights.hpp"

#include <algorithm>
#include <array>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

/// A value for every texel of rows [begin, end).
struct ValueOfClass {
  float covered, gutter, unseen;
};

std::vector<float> rowsOf(const raster::TexelClasses& classes, int begin, int end, const ValueOfClass& value) {
  const int width = classes.width();
  std::vector<float> rows(toSize(end - begin, width), value.unseen);
  for (int y = begin; y < end; ++y) {
    float* row = &rows[toSize(y - begin, width)];
    for (int x = 0; x < width; ++x) {
      const std::uint32_t bit = 1u << (x % kTileSide);
      if ((classes.covered(x / kTileSide, y) & bit) != 0) {
        row[x] = value.covered;
      } else if ((classes.active(x / kTileSide, y) & bit) != 0) {
        row[x] = value.gutter;
      }
    }
  }
  return rows;
}

}  // namespace

std::vector<float> blockWeights(const TileMasks& masks) {
  std::vector<float> weights = masks.texel_weights;
  for (std::size_t p = 0; p < weights.size(); ++p) {
    if (weights[p] == 0.0f && masks.mask_weights[p] > 0.0f) weights[p] = kGutterWeight;
  }
  return weights;
}

std::vector<float> neutralBlockWeights(const raster::TexelClasses& classes, int begin, int end) {
  return rowsOf(classes, begin, end, {1.0f, kGutterWeight, kUnseenWeight});
}

std::vector<float> coverageRows(const raster::TexelClasses& classes, int begin, int end) {
  return rowsOf(classes, begin, end, {1.0f, 0.0f, 0.0f});
}

}  // namespace facezip::compress
