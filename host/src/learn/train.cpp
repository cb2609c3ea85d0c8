// train.cpp - from a library of captures to a model: meshes and the shapes' regression, then the textures'.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "capture/capture_meshes.hpp"
#include "face/face.hpp"
#include "facezip/learn.hpp"
#include "facezip/printable.hpp"
#include "io/stage_clock.hpp"
#include "learn/face_model.hpp"
#include "learn/library.hpp"
#include "learn/texture_learning.hpp"

namespace facezip {

template <>
const std::vector<NamedValue<LearningMethod>>& namesOf() {
  static const std::vector<NamedValue<LearningMethod>> names = {{LearningMethod::kLinear, "linear", "linear"}};
  return names;
}

namespace {
using namespace learn;
namespace fs = std::filesystem;

void requireSaneOptions(const TrainOptions& options) {
  if (options.resolution < 16 || options.resolution > 1024) {
    throw InputError({"--resolution", "", "16 to 1024", fmt::format("{}", options.resolution), ""});
  }
  if (options.rounds < 1 || options.rounds > 100) {
    throw InputError({"--rounds", "", "1 to 100", fmt::format("{}", options.rounds), ""});
  }
}

std::string nameOfLibrary(const fs::path& directory) {
  const fs::path path = fs::absolute(directory).lexically_normal();  // "people/" ends in an empty name
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// The library's meshes, all in the frame of the first subject.
struct LibraryMeshes {
  geometry::TriangleMesh first;                              ///< topology and layout
  std::vector<Eigen::MatrixX3d> neutrals;                    ///< S
  std::vector<std::vector<Eigen::MatrixX3f>> displacements;  ///< S times N
};

LibraryMeshes readLibraryMeshes(const Library& library, const rig::RigTemplate& rig_template, Progress& progress) {
  LibraryMeshes meshes;
  progress.stage("reading meshes", library.subjects.size());
  const std::string first_file = library.subjects.front().neutral_mesh.string();
  const geometry::TriangleMesh first = CaptureMeshes(library.subjects.front()).neutral();
  rig::requireSkin(rig_template, first, first_file);
  Eigen::MatrixX3d frame;
  for (const Capture& subject : library.subjects) {
    progress.checkCancelled();
    SubjectMeshes one = readMeshes(subject, frame, &first, first_file, progress);
    if (meshes.neutrals.empty()) {
      frame = one.neutral.positions;
      meshes.first = one.neutral;
    }
    meshes.neutrals.push_back(one.neutral.positions);
    meshes.displacements.push_back(std::move(one.displacements));
    progress.advance(meshes.neutrals.size());
  }
  return meshes;
}

/// The template where the library's mean face is, in its size: parts beyond the skin too.
rig::RigTemplate placedTemplate(const rig::RigTemplate& source, const Eigen::MatrixX3d& mean) {
  rig::RigTemplate placed = source;
  const geometry::Similarity place =
      geometry::fitSimilarity(Eigen::MatrixX3d(source.neutral.positions.topRows(mean.rows())), mean);
  placed.neutral.positions = place.apply(source.neutral.positions);
  for (Eigen::MatrixX3d& shape : placed.shapes) shape = place.apply(shape);
  return placed;
}

geometry::ShapeLibrary shapeLibraryOf(LibraryMeshes& meshes, const rig::RigTemplate& placed,
                                      const Eigen::MatrixXd& asked) {
  geometry::ShapeLibrary shapes;
  const Eigen::Index skin = meshes.neutrals.front().rows();
  for (const Eigen::MatrixX3d& shape : placed.shapes) {
    shapes.template_shapes.emplace_back((shape - placed.neutral.positions).topRows(skin));
  }
  shapes.neutrals = meshes.neutrals;
  shapes.examples = std::move(meshes.displacements);
  shapes.asked = asked;
  return shapes;
}

/// The subjects as the model poses them, in place of the captured expressions: textures are learned from the strain
/// that generated shapes will have, not from that of shapes which no neutral tells.
void poseByModel(const geometry::ShapeRegression& regression, geometry::ShapeLibrary& shapes) {
  const Eigen::Index expressions = shapes.asked.rows();
  for (std::size_t s = 0; s < shapes.neutrals.size(); ++s) {
    std::vector<Eigen::MatrixX3d> own = regression.predict(shapes.neutrals[s], kMostScore);
    for (std::size_t m = 0; m < own.size(); ++m) own[m] += shapes.template_shapes[m];
    tbb::parallel_for(Eigen::Index{0}, expressions, [&](Eigen::Index e) {
      Eigen::MatrixX3d posed = Eigen::MatrixX3d::Zero(shapes.neutrals[s].rows(), 3);
      for (std::size_t m = 0; m < own.size(); ++m) {
        const double weight =
            regression.weights(static_cast<Eigen::Index>(s) * expressions + e, static_cast<Eigen::Index>(m));
        if (weight > 0.0) posed += weight * own[m];
      }
      shapes.examples[s][static_cast<std::size_t>(e)] = posed.cast<float>();
    });
  }
}

void reportShapes(const geometry::RegressionChoice& choice, TrainReport& report) {
  report.components = choice.components;
  report.softness = choice.softness;
  report.shared = choice.shared;
  report.noise = choice.noise;
  report.left_out_mm = choice.left_out;
  report.template_mm = choice.nothing;
}

}  // namespace

ProtectedPaths trainInputs(const fs::path& library, const fs::path& template_directory, const fs::path& facs) {
  ProtectedPaths paths;
  paths.add(library, "the library that is read").add(template_directory, "the template that is read");
  return paths.addFile(facs, "the asked weights that are read");
}

TrainReport trainModel(const fs::path& library_directory, const fs::path& template_directory, const fs::path& facs,
                       const fs::path& file, const TrainOptions& options, Progress& progress) {
  requireSaneOptions(options);
  trainInputs(library_directory, template_directory, facs).requireApart(file);
  io::StageClock clock;
  progress.stage("opening the library", 0);
  rig::RigTemplate rig_template = rig::readTemplate(template_directory, progress);
  const Library library = openLibrary(library_directory, facs, rig_template.names, options.maps, progress);
  LibraryMeshes meshes = readLibraryMeshes(library, rig_template, progress);
  rig_template.parts = rig::readTemplateParts(rig_template.neutral_file, rig_template.neutral, meshes.first);
  clock.book("reading meshes");

  FaceModel model;
  model.name = printable(nameOfLibrary(library_directory));
  Eigen::MatrixX3d mean = Eigen::MatrixX3d::Zero(meshes.first.positions.rows(), 3);
  for (const Eigen::MatrixX3d& neutral : meshes.neutrals) {
    mean += neutral / static_cast<double>(meshes.neutrals.size());
  }
  model.face_template = placedTemplate(rig_template, mean);
  geometry::ShapeLibrary shapes = shapeLibraryOf(meshes, model.face_template, library.asked);
  model.shapes = geometry::learnShapes(shapes, {options.rounds}, [&progress](const char* what) {
    progress.checkCancelled();
    progress.busy(what);
  });
  model.skin = meshes.first;
  model.skin.positions = model.shapes.identity.mean;
  clock.book("regressing shapes");

  poseByModel(model.shapes, shapes);
  TrainReport report;
  LearnedTextures textures = learnTextures(library, model.skin, shapes, options.resolution, progress);
  model.textures = std::move(textures.models);
  report.textures = std::move(textures.quality);
  clock.book("regressing textures");
  report.subjects = library.subjects.size();
  report.expressions = library.expressions;
  report.shapes = rig_template.names;
  report.skin_vertices = static_cast<int>(model.skin.positions.rows());
  reportShapes(model.shapes.choice, report);
  report.model_bytes = writeModel(file, model, progress);
  clock.book("writing the model");
  report.seconds = clock.seconds();
  return report;
}

}  // namespace facezip
