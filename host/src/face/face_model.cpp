#include "face/face_model.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "facezip/geometry/float_origin.hpp"

namespace facezip::compress {
namespace {

/// A face has some 60.
constexpr int kManyMasks = 500;

std::optional<Importance> readImportance(const Capture& capture, const CompressOptions& options) {
  const std::filesystem::path painted =
      options.importance.empty() ? capture.importance.value_or("") : std::filesystem::path(options.importance);
  if (painted.empty() || painted == "none") return std::nullopt;
  return Importance(painted);
}

}  // namespace

FaceModel readFaceModel(const Capture& capture, const CompressOptions& options, const device::Run& run) {
  FaceModel model;
  run.progress.stage("reading meshes", 0);
  model.face = readFace(capture, options.region);
  // Read even where the package gets no mesh: a mesh of another topology is a fault of the capture.
  model.expression_meshes = readExpressionMeshes(capture, run.progress);
  if (!options.mesh) model.expression_meshes.clear();
  const Eigen::RowVector3d origin = geometry::floatOrigin(model.face.mesh.positions);
  if (options.mesh && !origin.isZero(0.0)) run.progress.note(geometry::originNote(origin, "mesh.glb"));
  model.importance = readImportance(capture, options);
  run.clock.book("meshes");
  model.masks = makeFaceMasks(capture, model.face, options, run.progress);
  if (const int masks = model.masks.masks.mask_count; masks > kManyMasks) {
    run.progress.note(
        fmt::format("{} masks: the permutation search grows with their square; a larger --mask-radius "
                    "gives fewer",
                    masks));
  }
  return model;
}

}  // namespace facezip::compress
