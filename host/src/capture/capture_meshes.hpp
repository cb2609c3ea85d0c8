// capture_meshes.hpp - the meshes of a capture, in files of their own or as morph targets of one.
#pragma once

#include <optional>

#include "facezip/capture.hpp"
#include "facezip/geometry/mesh.hpp"
#include "scene/morph_mesh.hpp"

namespace facezip {

/// UVs are those of the capture's tile: [0, 1] is that tile, whichever it is.
class CaptureMeshes {
 public:
  /// Reads the neutral, and all morph targets where it has them. Throws InputError.
  explicit CaptureMeshes(Capture capture);

  const geometry::TriangleMesh& neutral() const { return morphs_.neutral; }
  /// Positions of an expression that has a mesh. Safe to call from any thread.
  /// Throws InputError: an unreadable mesh, one of another topology than the neutral.
  Eigen::MatrixX3d positions(std::size_t expression) const;

 private:
  Capture capture_;
  scene::MorphMesh morphs_;
};

}  // namespace facezip
