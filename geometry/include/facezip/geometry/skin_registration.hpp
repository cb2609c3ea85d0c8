// skin_registration.hpp - a registered mesh drawn along the skin to where textures say that its points are. Lengths in
// millimetres.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/nonrigid_registration.hpp"

namespace facezip::geometry {

/// A point of the mesh whose place on the scan is known.
struct SkinPoint {
  int triangle = 0;  ///< of the mesh
  Eigen::RowVector3d barycentric;
  Eigen::RowVector3d target;  ///< on the scan
  double trust = 1.0;         ///< 0..1, of the triangle's area
};

/// The Laplacian deformation of Li et al. 2020, section 7.1, with dense constraints: closest points hold the mesh on
/// the scan, skin points draw it along, and what neither of them says follows the fitted shapes. One factorisation
/// serves every round of every expression.
class SkinRegistration {
 public:
  /// Throws SolverError if the factorisation fails.
  explicit SkinRegistration(BentSurface surface);

  const BentSurface& surface() const { return surface_; }

  /// One round: the mesh drawn from `placed`.
  /// posed      #V by 3: the fitted shapes, from which displacements are smooth and slightly drawn back
  /// landmarks  weigh hardly anything: they hold where there is nothing else
  Eigen::MatrixX3d draw(const Eigen::MatrixX3d& posed, const Eigen::MatrixX3d& placed,
                        const std::vector<SkinPoint>& points, const ScanSurface& scan,
                        const std::vector<Landmark>& landmarks) const;

 private:
  BentSurface surface_;
  SurfaceDeformation deformation_;
};

}  // namespace facezip::geometry
