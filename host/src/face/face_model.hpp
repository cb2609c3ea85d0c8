// face_model.hpp - the geometry of a capture as a compression needs it: mesh, region, masks, meshes of expressions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "device/run.hpp"
#include "face/face.hpp"
#include "face/importance.hpp"

namespace facezip::compress {

struct FaceModel {
  Face face;
  FaceMasks masks;                                  ///< FaceZip 3.1, "Mask Computation"
  std::vector<Eigen::MatrixX3f> expression_meshes;  ///< N, some of 0 rows; empty where the package gets no mesh
  std::optional<Importance> importance;
};

/// Reads meshes and painted images, samples the region and solves the masks. Throws InputError, SolverError.
FaceModel readFaceModel(const Capture& capture, const CompressOptions& options, const device::Run& run);

}  // namespace facezip::compress
