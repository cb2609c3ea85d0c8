#include "rig/shape_package.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "facezip/geometry/float_origin.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/package.hpp"
#include "io/staged_directory.hpp"
#include "rig/rig_json.hpp"

namespace facezip::rig {
namespace fs = std::filesystem;
namespace {

/// The shapes as a capture has expressions. Their meshes are written into `folder`.
Capture captureOfShapes(const Capture& neutral, const ShapedFace& face, const std::vector<CaptureMap>& textures,
                        const fs::path& folder) {
  io::createDirectories(folder);
  Capture capture = neutral;
  capture.expressions = face.rig_template.names;
  capture.maps = textures;
  capture.expression_meshes.clear();
  for (std::size_t m = 0; m < capture.expressions.size(); ++m) {
    capture.expression_meshes.push_back(folder / (std::to_string(m) + ".obj"));
  }
  tbb::parallel_for(std::size_t{0}, capture.expressions.size(), [&](std::size_t m) {
    geometry::TriangleMesh mesh = face.subject.neutral;
    mesh.positions += face.rig.shapes[m];
    geometry::writeObj(capture.expression_meshes[m], mesh);
  });
  return capture;
}

/// Does any texture differ from its neutral?
bool changes(const std::vector<CaptureMap>& textures) {
  return std::ranges::any_of(textures, [](const CaptureMap& map) {
    return std::ranges::any_of(map.expressions, [&](const fs::path& file) { return file != map.neutral; });
  });
}

/// A package holds one difference texture at least: of nothing, where nothing changes. More would be memory for it.
CompressOptions optionsFor(const std::vector<CaptureMap>& textures, CompressOptions options, Progress& progress) {
  if (changes(textures) || options.method == Method::kCompressStretch) return options;
  options.differences = 1;
  options.target_rmse.reset();
  progress.note("the template has no textures: the neutral's is the same in every shape, one difference texture is 0");
  return options;
}

}  // namespace

void writeShapePackage(const Capture& neutral, const ShapedFace& face, const std::vector<CaptureMap>& textures,
                       const CompressOptions& options, const std::string& eyes, const fs::path& directory,
                       const Device& device, Progress& progress, RigReport& report) {
  const fs::path meshes = directory / ".shapes", compressed = directory / ".compressed";  // names that no map has
  const Capture capture = captureOfShapes(neutral, face, textures, meshes);
  report.compress = compressCapture(capture, compressed, optionsFor(textures, options, progress), device, progress);
  for (const fs::directory_entry& entry : fs::directory_iterator(compressed)) {
    fs::rename(entry.path(), directory / entry.path().filename());
  }
  fs::remove(compressed);
  fs::remove_all(meshes);

  progress.stage("writing shapes", 0);
  const RigFace whole = assembleFace(face.subject, face.rig_template, face.rig, eyes);
  report.shapes = face.rig_template.names;
  report.vertices = static_cast<int>(whole.neutral.positions.rows());
  report.skin_vertices = static_cast<int>(face.subject.neutral.positions.rows());
  report.parts = whole.pieces;
  for (std::size_t m = 0; m < report.shapes.size(); ++m) {
    if (face.rig.shapes[m].isZero(0.0)) report.still.push_back(report.shapes[m]);
  }
  const Package package = Package::open(directory);
  const Eigen::RowVector3d origin = geometry::floatOrigin(whole.neutral.positions);
  if (!origin.isZero(0.0)) progress.note(geometry::originNote(origin, "rig.gltf"));
  writeFace(directory, whole, report.shapes, neutral.name, geometry::metresPerUnit(face.subject.unit), package.maps());
  if (options.mesh) {
    writePackageParts(directory, whole, {}, {}, geometry::metresPerUnit(face.subject.unit));
  }
  io::writeTextFile(directory / kRigFile, rigJson(report, face.subject.millimetresPerUnit()));
}

}  // namespace facezip::rig
