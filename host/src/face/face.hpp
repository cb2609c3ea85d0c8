// face.hpp - the geometry of a capture: its mesh, the unit it is in, the part that changes and the masks on it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "facezip/capture.hpp"
#include "facezip/compress.hpp"
#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/length.hpp"
#include "facezip/geometry/mask_weights.hpp"
#include "facezip/geometry/mesh.hpp"
#include "facezip/geometry/surface_sampling.hpp"
#include "facezip/progress.hpp"

namespace facezip::compress {

/// The neutral mesh and the triangles of it whose textures change.
struct Face {
  geometry::TriangleMesh mesh;
  std::vector<int> region;         ///< sorted triangle indices
  std::string region_description;  ///< "face_region.txt", "coverage.png", "whole mesh", for reports
};

/// Reads the neutral mesh and finds the region: `region` as in CompressOptions::region.
/// Throws InputError: unreadable mesh, no UVs, UVs outside [0, 1], an empty region.
Face readFace(const Capture& capture, const std::string& region);

/// Reads every expression mesh of the capture and checks it against the neutral. Returns the positions of each, #V by
/// 3, less geometry::floatOrigin() of the neutral; 0 rows where an expression has no mesh. Throws InputError naming the
/// first that differs.
std::vector<Eigen::MatrixX3f> readExpressionMeshes(const Capture& capture, Progress& progress);

/// Positions of every expression's mesh, N. needed_for  for the message where one is missing, "its mesh, to ..."
/// Throws InputError where an expression has no mesh, or one of another topology.
std::vector<Eigen::MatrixX3d> readExpressionMeshes(const Capture& capture, const std::string& needed_for,
                                                   Progress& progress);

/// The masks of a face (FaceZip 3.1, "Mask Computation").
struct FaceMasks {
  std::optional<geometry::LengthUnit> unit;  ///< of the mesh; none where it is neither stated nor a head's
  bool unit_guessed = false;
  geometry::RegionMesh region;
  geometry::SurfaceSamples samples;
  geometry::MaskWeights masks;
};

/// Samples the region and solves the masks. Notes a guessed unit, and a size that is no head's.
/// Throws InputError and SolverError.
FaceMasks makeFaceMasks(const Capture& capture, const Face& face, const CompressOptions& options, Progress& progress);

}  // namespace facezip::compress
