// nonrigid_registration.hpp - a mesh bent onto a scan: closest points under a stiffness that falls. Lengths in
// millimetres.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "facezip/geometry/model_registration.hpp"
#include "facezip/geometry/scan_surface.hpp"
#include "facezip/geometry/surface_deformation.hpp"
#include "facezip/geometry/surface_matching.hpp"

namespace facezip::geometry {

/// What is bent: the template's triangles, and which of them a scan can show.
struct BentSurface {
  Eigen::MatrixX3d reference;  ///< #V by 3: the shape whose edges and areas define stiffness
  MatchedSurface matched;      ///< triangles that may be matched
  std::vector<bool> seen;      ///< #T: shown by the scan; others have no data and follow stiffly

  /// #V: 1 for corners of seen triangles, else 0.
  Eigen::VectorXd seenVertices() const;
};

/// Triangles whose centres have a scan before them that is not just its border; and those of small holes between them.
/// reach  millimetres
std::vector<bool> seenTriangles(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles,
                                const ScanSurface& scan, double reach = 15.0);

/// The stiffness of a surface: bending and membrane at a length, parts that are not seen stiffer.
Stiffness stiffnessAt(double length, double membrane_share, double anchor, const BentSurface& surface);

struct NonRigidOptions {
  double first_length = 60.0;  ///< stiffness (Stiffness::bending) of the first step, ...
  double last_length = 1.2;    ///< ... of the last one; in between by equal factors
  int steps = 9;               ///< factorisations
  int rounds = 7;              ///< of closest points in a step, at the most
  double first_kernel = 3.0;   ///< of the robust weights; it follows the residuals down to
  double last_kernel = 0.8;
  double landmark_share = 1.0;  ///< of the landmarks' usual weight: less where the start is surer than clicks
};

/// Bends the mesh from `start` onto the scan. Smoothness is of what each step adds to the last one's result. Ends
/// before the last length once half of the matches lie within the scan's own roughness: a softer mesh would follow
/// noise. landmarks  draw along the surface alone: how deep they lie, the scan says better round      called before
/// each round; may be empty Throws SolverError.
Eigen::MatrixX3d registerNonRigid(const BentSurface& surface, const Eigen::MatrixX3d& start, const ScanSurface& scan,
                                  const std::vector<Landmark>& landmarks, const NonRigidOptions& options,
                                  const std::function<void()>& round = {});

/// Distances of a scan's points from the mesh, in millimetres: those within `reach` of a triangle that faces as they
/// do, the border left out. For reports.
struct ScanResidual {
  double mean = 0.0;
  double percentile_99 = 0.0;
  double matched = 0.0;  ///< share of the scan's points, by area
};
ScanResidual residualOf(const BentSurface& surface, const Eigen::MatrixX3d& positions, const ScanSurface& scan,
                        double reach = 10.0);

}  // namespace facezip::geometry
