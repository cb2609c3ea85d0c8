// scan_trust.hpp - which parts of a scan are surface, and which are what stereo makes of hair, edges and noise.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace facezip::geometry {

/// A scan without its spikes.
struct TrustedScan {
  Eigen::MatrixX3d positions;  ///< #V by 3: as scanned, spikes put back to their neighbours
  std::vector<float> trust;    ///< #T, 0..1: how far the shape of a triangle is believed in
  int spikes = 0;              ///< vertices that were put back
  double roughness = 0.0;      ///< robust standard deviation of vertices from their neighbours, in the unit of the mesh
};

/// Finds spikes (vertices far from the plane of their neighbours, beside the roughness of the whole scan) and long
/// triangles (webs over a mouth or an eye). Both keep their place in the texture.
TrustedScan judgeScan(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles);

}  // namespace facezip::geometry
