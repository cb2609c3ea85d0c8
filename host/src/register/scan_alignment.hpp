// scan_alignment.hpp - a scan and its landmarks in millimetres, and what can be wrong with them.
#pragma once

#include <string>
#include <vector>

#include "facezip/geometry/model_registration.hpp"
#include "facezip/geometry/scan_surface.hpp"
#include "facezip/progress.hpp"
#include "register/registration_template.hpp"
#include "register/scan_files.hpp"

namespace facezip::registration {

/// A scan that a mesh can be registered to.
struct PlacedScan {
  Scan scan;  ///< its mesh in millimetres
  geometry::ScanSurface surface;
  std::vector<geometry::Landmark> landmarks;
};

/// Reads a scan. Landmarks that lie off its surface, or that the template does not have, are left out; triangles that
/// face inwards are turned about; both are noted, as is what cleaning did.
/// mesh  the template, or the registered neutral, that the landmarks' vertices belong to, in millimetres or not: only
///       for which way is out
/// Throws InputError: too few landmarks, or most of them off the surface; those of readScan().
PlacedScan placeScan(const std::filesystem::path& file, double millimetres_per_unit, const ScanLandmarks& landmarks,
                     const std::filesystem::path& landmark_file, const TemplateLandmarks& vertices,
                     const geometry::TriangleMesh& mesh, Progress& progress);

/// How far the landmarks are from the mesh's vertices, root mean square.
double landmarkRms(const std::vector<geometry::Landmark>& landmarks, const Eigen::MatrixX3d& mesh);

/// The similarity by landmarks. Throws InputError where they are a mirror image, or do not fit at all.
/// largest_rms  in millimetres, of the scan
geometry::Similarity alignOrRefuse(const PlacedScan& placed, const Eigen::MatrixX3d& mesh, bool fixed_scale,
                                   double largest_rms);

}  // namespace facezip::registration
