// uv_raster.hpp - which point of the surface each texel shows, in bands of rows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::raster {

/// The surface point of a texel: a triangle and barycentric coordinates in it.
struct TexelSample {
  /// How the texel got its point.
  enum class Kind : std::uint8_t {
    kEmpty,    ///< shows no part of the region, and none is near
    kCovered,  ///< its centre lies in a triangle of the region
    kGutter,   ///< outside every triangle, point of the nearest covered texel
    kFeather,  ///< in a triangle that is not of the region, near a covered texel, whose point it has
    kOutside,  ///< its centre lies in another triangle that is not of the region
  };
  std::int32_t triangle = -1;  ///< index into the mesh's triangles; -1 when kEmpty or kOutside
  float b0 = 0.0f;             ///< barycentric coordinate of corner 0
  float b1 = 0.0f;             ///< of corner 1; corner 2 has 1 - b0 - b1
  Kind kind = Kind::kEmpty;
  std::uint8_t fade = 255;  ///< share of its differences that counts, in 1/255: less in the feather alone
};

/// Rasterises a mesh's UV triangles at one image size. Row 0 is v = 1; texel (x, y) has its centre at
/// u = (x + 0.5) / width, v = 1 - (y + 0.5) / height. A texel whose centre lies in several triangles (on an edge, or
/// where UVs overlap) takes the lowest triangle index.
class UvRaster {
 public:
  /// mesh    has UVs in [0, 1]
  /// region  sorted indices of the triangles that change; kCovered texels lie in these
  /// gutter  texels this near (Euclidean, in texels) to a covered one and outside every triangle become kGutter, so
  /// that
  ///         bilinear filtering, and mip levels up to log2(gutter), never mix in a texel without masks at an island's
  ///         edge
  /// feather texels this near to a covered one in triangles that are not of the region become kFeather, where no gap
  ///         of the layout lies between: there differences fade out
  UvRaster(const geometry::TriangleMesh& mesh, std::span<const int> region, int width, int height, int gutter,
           int feather = 0);

  int width() const { return width_; }
  int height() const { return height_; }
  int gutter() const { return gutter_; }
  int feather() const { return feather_; }
  /// How far texels reach for others.
  int reach() const { return std::max(gutter_, feather_); }

  /// Samples rows [begin, end), row-major, width() per row. Any band gives the same samples as the whole image.
  std::vector<TexelSample> rows(int begin, int end) const;

  /// The same without the gutter, whose texels are kEmpty, and the feather, whose are kOutside.
  std::vector<TexelSample> coveredRows(int begin, int end) const;

 private:
  struct UvTriangle {
    double x[3], y[3];     ///< corners in texels, y down, texel centres at integers
    double inverse_area2;  ///< 1 / (twice the signed area)
    std::int32_t index;
    bool in_region;
  };
  /// Fills rows [begin, end); samples  from row `first` on
  void fillTriangle(const UvTriangle& triangle, int begin, int end, int first, std::span<TexelSample> samples) const;

  int width_;
  int height_;
  int gutter_;
  int feather_;
  std::vector<UvTriangle> triangles_;  ///< sorted by their first row, for bands
  std::vector<int> first_row_;         ///< of triangles_, same order
  int tallest_ = 0;                    ///< most rows that one triangle spans
};

}  // namespace facezip::raster
