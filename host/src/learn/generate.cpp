// generate.cpp - a neutral and a model in, a package out: the model's shapes on the subject, their textures, and from
// there what `rig` does.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "capture/capture_meshes.hpp"
#include "face/face.hpp"
#include "facezip/geometry/topology.hpp"
#include "facezip/learn.hpp"
#include "io/stage_clock.hpp"
#include "io/staged_directory.hpp"
#include "learn/face_model.hpp"
#include "learn/library.hpp"
#include "learn/texture_learning.hpp"
#include "package/footprint.hpp"
#include "rig/iris.hpp"
#include "rig/shape_package.hpp"

namespace facezip {
namespace {
using namespace learn;
namespace fs = std::filesystem;

constexpr double kStrange = 2.0;

/// The subject in its own place, size and unit.
struct Subject {
  geometry::TriangleMesh neutral;
  geometry::LengthUnit unit = geometry::LengthUnit::kMillimetre;
  double millimetres_per_unit = 1.0;
  geometry::Similarity to_model;  ///< millimetres of the subject to the model's frame, rigid
};

void requireTopology(const geometry::TriangleMesh& neutral, const fs::path& mesh_file, const FaceModel& model,
                     const fs::path& file) {
  try {
    geometry::requireSameTopology(model.skin, fmt::format("the faces of {}", file.string()), neutral,
                                  mesh_file.string());
  } catch (const InputError& error) {
    InputError::Parts parts = error.parts();
    parts.cure = fmt::format(
        "bring the scan into the topology and layout of the library that the model learned from "
        "(\"{}\"), with `facezip register`, or train a model of this topology",
        model.name);
    throw InputError(parts);
  }
}

Subject readSubject(const Capture& capture, const FaceModel& model, const fs::path& file, const std::string& unit,
                    Progress& progress) {
  Subject subject;
  subject.neutral = CaptureMeshes(capture).neutral();
  requireTopology(subject.neutral, capture.neutral_mesh, model, file);
  geometry::requireUvs(subject.neutral, capture.neutral_mesh.string());
  subject.unit = unitOf(capture, subject.neutral, unit, progress);
  subject.millimetres_per_unit = 1000.0 * geometry::metresPerUnit(subject.unit);
  subject.to_model = geometry::fitSimilarity(subject.millimetres_per_unit * subject.neutral.positions,
                                             model.skin.positions, {}, /* fixed_scale= */ true);
  return subject;
}

/// The neutral in the model's frame, its unusual components cut.
struct Identity {
  Eigen::MatrixX3d neutral;
  double strangeness = 0.0;
};

Identity identityOf(const Subject& subject, const FaceModel& model, Progress& progress) {
  Identity identity;
  identity.neutral = subject.to_model.apply(subject.millimetres_per_unit * subject.neutral.positions);
  const Eigen::VectorXd scores = model.shapes.identity.scores(identity.neutral);
  identity.strangeness = std::sqrt(scores.squaredNorm() / static_cast<double>(scores.size()));
  if (identity.strangeness > kStrange) {
    progress.note(
        fmt::format("the neutral is unlike those that the model learned from: {:.1f} times as far from their "
                    "mean as is usual; its shapes may suit it little",
                    identity.strangeness));
  }
  return identity;
}

/// Displacements in the model's frame become the subject's.
std::vector<Eigen::MatrixX3d> onSubject(const std::vector<Eigen::MatrixX3d>& displacements, const Subject& subject) {
  const Eigen::Matrix3d back = subject.to_model.turn / subject.millimetres_per_unit;  // rows: x R undoes x R^T
  std::vector<Eigen::MatrixX3d> moved;
  for (const Eigen::MatrixX3d& displacement : displacements) moved.emplace_back(displacement * back);
  return moved;
}

/// The regression that the neutral's maps suffice for; null where none does.
const TextureRegression* regressionFor(const TextureModel& model, const Capture& capture) {
  const auto has = [&](const std::string& name) {
    return std::ranges::find(capture.maps, name, &CaptureMap::name) != capture.maps.end();
  };
  const auto found = std::ranges::find_if(model.regressions, [&](const TextureRegression& regression) {
    return std::ranges::all_of(regression.maps, has);
  });
  return found == model.regressions.end() ? nullptr : &*found;
}

/// Textures of the shapes, written into `folder`: the neutral's maps, with an image for each shape.
std::vector<CaptureMap> generateTextures(const Capture& capture, const FaceModel& model,
                                         const geometry::TriangleMesh& neutral, const std::vector<int>& region,
                                         const std::vector<Eigen::MatrixX3d>& shapes, const fs::path& folder,
                                         GenerateReport& report, Progress& progress) {
  std::vector<CaptureMap> maps = capture.maps;
  progress.stage("generating textures", maps.size() * shapes.size());
  std::size_t done = 0;
  for (CaptureMap& map : maps) {
    map.expressions.assign(shapes.size(), map.neutral);
    const auto texture = std::ranges::find(model.textures, map.name, &TextureModel::map);
    const TextureRegression* regression = texture == model.textures.end() ? nullptr : regressionFor(*texture, capture);
    (regression == nullptr ? report.left_alone : report.maps).push_back(map.name);
    if (regression == nullptr) continue;
    const TexelStrain strain(neutral, region, texture->side);
    const std::vector<image::FloatImage> textures =
        readNeutralTextures(capture, regression->maps, regression->channels, texture->side);
    const Eigen::MatrixXf features = textureFeatures(textures, strain.texels());
    const std::size_t own =
        static_cast<std::size_t>(std::ranges::find(regression->maps, map.name) - regression->maps.begin());
    const Eigen::RowVectorXf levels = levelsOf(textures[own], strain.texels());
    io::createDirectories(folder / map.name);
    const std::string extension = image::losslessExtension(map.neutral);
    for (std::size_t m = 0; m < shapes.size(); ++m) {
      map.expressions[m] = folder / map.name / fmt::format("{}{}", m, extension);
    }
    tbb::parallel_for(std::size_t{0}, shapes.size(), [&](std::size_t m) {
      const Eigen::MatrixXf change = predictTexture(*regression, strain.of(shapes[m]), features) * levels.asDiagonal();
      image::writeChanged(map.neutral, strain.imageOf(change), map.expressions[m]);
    });
    progress.checkCancelled();
    progress.advance(done += shapes.size());
  }
  return maps;
}

}  // namespace

ProtectedPaths generateInputs(const Capture& neutral, const fs::path& model, const GenerateOptions& options) {
  return inputsOf(neutral, options.compress).addFile(model, "the model that is read");
}

GenerateReport generateFace(const Capture& capture, const fs::path& file, const fs::path& package,
                            const GenerateOptions& options, const Device& device, Progress& progress) {
  rig::findIris(options.eyes, "--eyes");
  generateInputs(capture, file, options).requireApartFromFolder(package);
  io::StageClock clock;
  io::StagedDirectory staged(package, package::footprint(), &progress);
  progress.stage("reading the model", 0);
  FaceModel model = readModel(file);
  const Subject subject = readSubject(capture, model, file, options.compress.unit.value_or(""), progress);
  clock.book("reading the model");

  GenerateReport report;
  const Identity identity = identityOf(subject, model, progress);
  report.strangeness = identity.strangeness;
  rig::ShapedFace face{std::move(model.face_template), {}, {}};
  face.subject.neutral = subject.neutral;
  face.subject.unit = subject.unit;
  const Eigen::Index skin = subject.neutral.positions.rows();
  std::vector<Eigen::MatrixX3d> of_template;
  for (const Eigen::MatrixX3d& shape : face.rig_template.shapes) {
    of_template.emplace_back((shape - face.rig_template.neutral.positions).topRows(skin));
  }
  const std::vector<Eigen::MatrixX3d> offsets = model.shapes.predict(identity.neutral, kMostScore);
  std::vector<Eigen::MatrixX3d> shapes = of_template;
  for (std::size_t m = 0; m < shapes.size(); ++m) shapes[m] += offsets[m];
  face.rig.transferred = onSubject(of_template, subject);
  face.rig.shapes = onSubject(shapes, subject);
  clock.book("shapes");

  geometry::TriangleMesh in_frame = subject.neutral;
  in_frame.positions = identity.neutral;
  const std::vector<int> region = compress::readFace(capture, options.compress.region).region;
  const fs::path scratch = staged.path() / ".textures";  // a name that no map has
  const std::vector<CaptureMap> textures =
      generateTextures(capture, model, in_frame, region, shapes, scratch, report, progress);
  if (!report.left_alone.empty()) {
    progress.note(fmt::format("{}: the model knows nothing of it, so it stays as it is in every shape",
                              fmt::join(report.left_alone, ", ")));
  }
  clock.book("textures");
  rig::writeShapePackage(capture, face, textures, options.compress, options.eyes, staged.path(), device, progress,
                         report.rig);
  report.rig.transfer = "model";
  fs::remove_all(scratch);
  clock.book("compressing");
  staged.commit();
  clock.book("publishing");
  report.rig.seconds = clock.seconds();
  return report;
}

}  // namespace facezip
