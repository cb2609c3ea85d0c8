// chart_raster.hpp - which point of the mesh each texel shows.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "facezip/geometry/mesh.hpp"

namespace facezip::synth {

/// A point of the mesh: (1 - b1 - b2) * corner 0 + b1 * corner 1 + b2 * corner 2 of a triangle.
struct MeshPoint {
  std::int32_t triangle = -1;
  float b1 = 0.0f;
  float b2 = 0.0f;
};

/// Finds the mesh point of every texel centre of a square image; texels outside the chart get the nearest point of its
/// border, so that the gutter and the holes continue the skin.
class ChartRaster {
 public:
  /// mesh        one chart without overlaps, every triangle counter-clockwise in UV; kept by reference
  /// resolution  side of the image in texels
  ChartRaster(const geometry::TriangleMesh& mesh, int resolution);

  /// Fills `points` (one per texel) for image row `row`, row 0 at v = 1.
  void rasteriseRow(int row, std::span<MeshPoint> points) const;

 private:
  struct BorderEdge {
    std::int32_t triangle;
    int corner;  ///< the edge runs from this corner of the triangle to the next
    Eigen::Vector2d from, to;
  };

  void fillCovered(int row, std::span<MeshPoint> points) const;
  MeshPoint nearestOnBorder(const Eigen::Vector2d& uv) const;
  void collectBorder();
  void binBorder();
  Eigen::Vector2d corner(std::int32_t triangle, int k) const;

  static constexpr int kBins = 64;  ///< the UV square is cut into 64 x 64 bins for the search of the border

  const geometry::TriangleMesh& mesh_;
  int resolution_;
  std::vector<std::vector<std::int32_t>> triangles_of_row_;  ///< per band of kRowsPerBucket rows
  std::vector<BorderEdge> border_;
  std::vector<std::vector<std::int32_t>> border_of_bin_;
};

}  // namespace facezip::synth
