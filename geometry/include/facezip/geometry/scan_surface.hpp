// scan_surface.hpp - a raw scan, cleaned and made ready for registration.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/closest_surface.hpp"
#include "facezip/geometry/mesh.hpp"
#include "facezip/geometry/scan_trust.hpp"
#include "facezip/geometry/surface_matching.hpp"

namespace facezip::geometry {

/// What cleanScan() did.
struct ScanCleaning {
  int welded_vertices = 0;  ///< vertices at exactly the place of another one
  int flat_triangles = 0;   ///< triangles without area
  int loose_triangles = 0;  ///< triangles of small parts beside the largest one
  int crowded_edges = 0;    ///< edges of more than two triangles; they stay
  bool any() const { return welded_vertices + flat_triangles + loose_triangles > 0; }
};

/// Welds vertices at the same place (exporters split them at texture seams, which would be borders), then drops
/// triangles without area and parts of less than a hundredth of the largest part's area. UVs stay with the triangles.
/// kept  receives the rows of `scan.triangles` that are left, ascending; may be null
/// Throws InputError if nothing is left.
ScanCleaning cleanScan(TriangleMesh& scan, std::vector<int>* kept = nullptr);

/// A scan that meshes are registered to. Lengths in millimetres.
class ScanSurface {
 public:
  /// most_points  more vertices than these are thinned out evenly, as points that ask for their place on the template
  ScanSurface(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, int most_points = 60000);

  const TrustedScan& judged() const { return judged_; }
  const ClosestSurface& surface() const { return surface_; }
  const ScanPoints& points() const { return points_; }
  /// Length of the diagonal of the bounding box.
  double diagonal() const { return diagonal_; }

 private:
  TrustedScan judged_;
  ClosestSurface surface_;
  ScanPoints points_;
  double diagonal_;
};

}  // namespace facezip::geometry
