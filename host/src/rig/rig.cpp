// rig.cpp - from a capture and a template to an animatable face: meshes and template, the fit, the package of the
// capture, textures and meshes of the shapes. Each stage hands what it found to the next.
#include "facezip/rig.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "facezip/geometry/float_origin.hpp"
#include "facezip/package.hpp"
#include "io/safe_names.hpp"
#include "io/stage_clock.hpp"
#include "package/footprint.hpp"
#include "rig/iris.hpp"
#include "rig/moving_head.hpp"
#include "rig/rig_json.hpp"
#include "rig/rig_meshes.hpp"
#include "rig/rig_weights.hpp"
#include "rig/shape_package.hpp"
#include "rig/strain_codes.hpp"
#include "rig/template_textures.hpp"
#include "rig/weight_guess.hpp"

namespace facezip {
namespace {
using namespace rig;
namespace fs = std::filesystem;

/// A shape that no expression uses by more than this is the template's own.
constexpr double kSeen = 0.05;
/// Share of the shapes' weights that is worth a note when it is clamped.
constexpr double kMuchClamped = 0.01;

RigResidual inMillimetres(const geometry::Distances& distances, double scale) {
  return {scale * distances.mean, scale * distances.percentile_99, scale * distances.largest};
}

std::vector<std::vector<double>> rowsOf(const Eigen::MatrixXd& matrix) {
  std::vector<std::vector<double>> rows;
  for (const auto& row : matrix.rowwise()) rows.emplace_back(row.begin(), row.end());
  return rows;
}

/// Names of the captured expressions in a package that has shapes too. A shape keeps its name: it is what is animated.
std::vector<std::string> packageNamesOf(const std::vector<std::string>& expressions,
                                        const std::vector<std::string>& shapes, const std::string& file,
                                        Progress& progress) {
  const auto taken = [&](const std::string& name, const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<std::string> renamed = expressions;
  for (std::string& name : renamed) {
    if (!taken(name, shapes)) continue;
    const std::string before = name;
    std::string longer = name;
    do longer += "_captured";
    while (taken(longer, shapes) || taken(longer, renamed));
    if (const auto fault = io::nameFault(longer)) {
      throw InputError({file, "an expression, with _captured since it names a shape too", fault->expected, fault->got,
                        "rename the shape or the expression"});
    }
    name = longer;
    progress.note(fmt::format("\"{}\" names a shape too: the captured expression is \"{}\"", before, name));
  }
  return renamed;
}

RigHeadMotion headMotionOf(const geometry::Similarity& motion, const Eigen::MatrixX3d& neutral, double scale) {
  const double degrees = Eigen::AngleAxisd(motion.turn).angle() * 180.0 / std::numbers::pi;
  return {degrees, scale * geometry::distancesBetween(motion.apply(neutral), neutral).mean};
}

void requireSaneOptions(const RigOptions& options) {
  findIris(options.eyes, "--eyes");
  textureSolveOf(options);
  if (options.fit.iterations < 0 || options.fit.iterations > 1000) {
    throw InputError({"--iterations", "", "0 to 1000", fmt::format("{}", options.fit.iterations), ""});
  }
  if (options.texture_damping && !(*options.texture_damping > 0.0 && *options.texture_damping <= 1e6)) {
    throw InputError(
        {"--texture-damping", "", "above 0 and at most 1e6", fmt::format("{}", *options.texture_damping), ""});
  }
}

/// What a rig is made of, read and checked.
struct RigInputs {
  RigTemplate rig_template;
  RigSubject subject;
  Eigen::MatrixXd guess;                         ///< N by M; no rows without one
  std::vector<std::string> package_expressions;  ///< N
};

RigInputs readInputs(const Capture& capture, const fs::path& template_directory, const RigOptions& options,
                     Progress& progress) {
  progress.stage("reading the template", 0);
  RigInputs inputs;
  inputs.rig_template = readTemplate(template_directory, progress);
  requireRigSize(inputs.rig_template.names.size(), capture.expressions.size(), template_directory.string());
  inputs.subject = readSubject(capture, options, progress);
  requireSkin(inputs.rig_template, inputs.subject.neutral, capture.neutral_mesh.string());
  inputs.rig_template.parts =
      readTemplateParts(inputs.rig_template.neutral_file, inputs.rig_template.neutral, inputs.subject.neutral);
  const std::vector<std::string>& shapes = inputs.rig_template.names;
  if (!options.guess.empty()) inputs.guess = readGuess(options.guess, capture.expressions, shapes);
  inputs.package_expressions = packageNamesOf(capture.expressions, shapes, capture.directory.string(), progress);
  return inputs;
}

/// The skin of subject and template, as the fit takes it.
geometry::RigProblem problemOf(const RigInputs& inputs) {
  const RigTemplate& source = inputs.rig_template;
  geometry::RigProblem problem;
  problem.neutral = inputs.subject.neutral.positions;
  problem.triangles = inputs.subject.neutral.triangles;
  const Eigen::Index skin = problem.neutral.rows();
  problem.template_neutral = source.neutral.positions.topRows(skin);
  for (const Eigen::MatrixX3d& shape : source.shapes) problem.template_shapes.emplace_back(shape.topRows(skin));
  problem.examples = inputs.subject.expressions;
  problem.guess = inputs.guess;
  return problem;
}

geometry::ExampleRig fitRig(const geometry::RigProblem& problem, const RigOptions& options, Progress& progress) {
  progress.stage("fitting the rig", static_cast<std::size_t>(options.fit.iterations));
  return geometry::fitExampleRig(problem, options.fit, [&progress](int iteration) {
    progress.checkCancelled();
    progress.advance(static_cast<std::size_t>(iteration));
  });
}

/// What the report says of the fit.
RigReport reportFit(const Capture& capture, const RigInputs& inputs, const geometry::ExampleRig& rig) {
  RigReport report;
  report.expressions = capture.expressions;
  report.shapes = inputs.rig_template.names;
  report.package_expressions = inputs.package_expressions;
  report.skin_vertices = static_cast<int>(inputs.subject.neutral.positions.rows());
  const double scale = inputs.subject.millimetresPerUnit();
  report.weights = rowsOf(rig.weights);
  for (const auto& residual : rig.residuals) report.residuals.push_back(inMillimetres(residual, scale));
  for (const auto& residual : rig.template_residuals) {
    report.template_residuals.push_back(inMillimetres(residual, scale));
  }
  for (const double rms : rig.convergence) report.convergence.push_back(scale * rms);
  for (const geometry::Similarity& motion : rig.head_motions) {
    report.head_motions.push_back(headMotionOf(motion, inputs.subject.neutral.positions, scale));
  }
  report.transfer = rig.transfer == geometry::ShapeTransfer::kGradients ? "deformation gradients" : "displacements";
  report.shape_prior = rig.shape_prior;
  report.left_out_share = rig.left_out_template > 0.0 ? rig.left_out / rig.left_out_template : 1.0;
  report.degenerate_triangles = rig.degenerate_triangles;
  for (std::size_t m = 0; m < report.shapes.size(); ++m) {
    if (rig.shapes[m].isZero(0.0)) {
      report.still.push_back(report.shapes[m]);
    } else if (rig.weights.col(static_cast<Eigen::Index>(m)).maxCoeff() <= kSeen) {
      report.unseen.push_back(report.shapes[m]);
    }
  }
  return report;
}

void noteWhatIsUnusual(const RigReport& report, double rigid_share, bool head_motion, Progress& progress) {
  if (!head_motion) {
    noteMovingHead("the template does not explain of the expressions", rigid_share, report.template_residuals,
                   progress);
  }
  if (4 * report.expressions.size() < report.shapes.size()) {
    progress.note(fmt::format("{} shapes from {} expression{}: most of the rig is the template's", report.shapes.size(),
                              report.expressions.size(), report.expressions.size() == 1 ? "" : "s"));
  }
  if (!report.unseen.empty()) {
    progress.note(fmt::format("no expression shows {}: as the template has them", fmt::join(report.unseen, ", ")));
  }
  if (!report.still.empty()) {
    progress.note(fmt::format("{}: the template's shape moves nothing", fmt::join(report.still, ", ")));
  }
  if (report.degenerate_triangles > 0) {
    progress.note(fmt::format("{} triangles of the neutral have no area: their vertices follow their neighbours",
                              report.degenerate_triangles));
  }
}

/// How the shapes' textures were found.
struct ShapeTextures {
  ChosenSolve chosen;
  int rank = 0;  ///< of the expressions' weights
};

/// Adds the shapes' weight maps to the package of the captured expressions.
ShapeTextures addShapeTextures(const Capture& capture, const fs::path& directory, const RigInputs& inputs,
                               const geometry::ExampleRig& rig, const RigOptions& options, Progress& progress) {
  const Package package = Package::open(directory);
  const compress::Face face = compress::readFace(capture, options.compress.region);
  const PackageMaps maps = openPackageMaps(capture, face, package);
  ShapeTextures textures;
  textures.rank = rankOf(rig.weights);
  std::optional<SkinFeatures> features;
  SolveSet solve = [&](const Package& of, int set, const compress::GridMap& map) {
    return strainShapes(of, set, inputs.subject.neutral, rig, map);
  };
  if (textureSolveOf(options) != TextureSolve::kStrain) {
    features.emplace(inputs.subject.neutral, rig.examples, rig);
    textures.chosen = chooseSolve(options, rig.weights, *features, maps, progress);
    solve = [&](const Package& of, int set, const compress::GridMap& map) {
      return solveShapes(of, set, textures.chosen.solver, *features, map, progress);
    };
  }
  if (textures.rank < static_cast<int>(capture.expressions.size())) {
    progress.note(
        fmt::format("the expressions' weights have rank {}, not {}: some repeat or combine others; of twins, "
                    "give one",
                    textures.rank, capture.expressions.size()));
  }
  const double clamped = addShapeWeights(directory, inputs.package_expressions, inputs.rig_template.names, solve, maps);
  const bool pseudo_inverse = textureSolveOf(options) == TextureSolve::kPseudoInverse;
  if (clamped > (pseudo_inverse ? 0.0 : kMuchClamped)) {
    progress.note(
        fmt::format("{:.2g} % of the shapes' weights lie far beyond those of the captured expressions and are "
                    "clamped{}: the expressions hardly tell some shapes apart",
                    100.0 * clamped, pseudo_inverse ? ", so that Eq. 10 does not hold there" : ""));
  }
  return textures;
}

void reportTextures(const ShapeTextures& textures, const RigOptions& options, RigReport& report) {
  report.texture_rank = textures.rank;
  const TextureSolve solve = textureSolveOf(options);
  const bool damped = solve == TextureSolve::kLocal || solve == TextureSolve::kDamped;
  report.texture_solve = nameOf(solve);
  report.texture_damping = damped ? textures.chosen.solver.damping : 0.0;
  report.strain_share = textures.chosen.solver.strain_share;
  report.left_out_rmse = textures.chosen.left_out_rmse;
  report.left_out_nothing = textures.chosen.left_out_nothing;
}

/// shapes/, parts/, rig.gltf, mesh.glb and parts.glb.
void writeMeshes(const RigInputs& inputs, const RigFace& face, const geometry::ExampleRig& rig,
                 const std::string& title, bool package_mesh, const fs::path& directory, Progress& progress) {
  const std::vector<std::string>& shapes = inputs.rig_template.names;
  const Package package = Package::open(directory);
  const Eigen::RowVector3d origin = geometry::floatOrigin(face.neutral.positions);
  if (!origin.isZero(0.0)) progress.note(geometry::originNote(origin, "rig.gltf"));
  writeFace(directory, face, shapes, title, geometry::metresPerUnit(inputs.subject.unit), package.maps());
  if (!package_mesh) return;
  writePackageMesh(directory, inputs.subject, rig, inputs.package_expressions, shapes, title);
  writePackageParts(directory, face, inputs.subject.expressions, rig.weights,
                    geometry::metresPerUnit(inputs.subject.unit));
}

/// The template's shapes on a neutral that no expression was captured of.
geometry::ExampleRig transferRig(const ShapedFace& face, geometry::ShapeTransfer transfer) {
  const Eigen::MatrixX3d& neutral = face.subject.neutral.positions;
  const Eigen::Index skin = neutral.rows();
  const Eigen::MatrixX3d template_neutral = face.rig_template.neutral.positions.topRows(skin);
  std::vector<Eigen::MatrixX3d> template_shapes;
  for (const Eigen::MatrixX3d& shape : face.rig_template.shapes) template_shapes.emplace_back(shape.topRows(skin));
  geometry::ExampleRig rig;
  // Nothing tells which of the two is the better: gradients keep folds and lids together on a head of other
  // proportions.
  const bool displace = transfer == geometry::ShapeTransfer::kDisplacements;
  rig.transfer = displace ? geometry::ShapeTransfer::kDisplacements : geometry::ShapeTransfer::kGradients;
  rig.transferred =
      displace ? geometry::displacedShapes(template_neutral, template_shapes, neutral)
               : geometry::transferShapes(template_neutral, template_shapes, neutral, face.subject.neutral.triangles);
  rig.shapes = rig.transferred;
  return rig;
}

/// rigCapture() of a neutral alone.
RigReport rigNeutral(const Capture& capture, const fs::path& template_directory, const fs::path& package,
                     const RigOptions& options, const Device& device, Progress& progress) {
  if (!options.guess.empty()) {
    throw InputError({options.guess.string(), "weights of the expressions", "a capture with expressions",
                      "a neutral alone", "leave --weights out"});
  }
  io::StageClock clock;
  io::StagedDirectory staged(package, package::footprint(), &progress);
  RigInputs inputs = readInputs(capture, template_directory, options, progress);
  clock.book("reading meshes");

  progress.stage("transferring the template's shapes", 0);
  ShapedFace face{std::move(inputs.rig_template), std::move(inputs.subject), {}};
  face.rig = transferRig(face, options.fit.transfer);
  clock.book("transferring shapes");

  const fs::path scratch = staged.path() / ".textures";  // a name that no map has
  const std::vector<CaptureMap> textures =
      transferTextures(capture.maps, template_directory, face.rig_template.names, scratch, progress);
  clock.book("transferring textures");

  RigReport report;
  report.transfer =
      face.rig.transfer == geometry::ShapeTransfer::kGradients ? "deformation gradients" : "displacements";
  writeShapePackage(capture, face, textures, options.compress, options.eyes, staged.path(), device, progress, report);
  fs::remove_all(scratch);
  clock.book("compressing");
  staged.commit();
  clock.book("publishing");
  report.seconds = clock.seconds();
  return report;
}

}  // namespace

ProtectedPaths inputsOf(const Capture& capture, const fs::path& template_directory, const RigOptions& options) {
  return inputsOf(capture, options.compress)
      .add(template_directory, "the template that is read")
      .addFile(options.guess, "the weights that are read");
}

RigReport rigCapture(const Capture& capture, const fs::path& template_directory, const fs::path& package,
                     const RigOptions& options, const Device& device, Progress& progress) {
  requireSaneOptions(options);
  inputsOf(capture, template_directory, options).requireApartFromFolder(package);
  if (capture.expressions.empty()) return rigNeutral(capture, template_directory, package, options, device, progress);
  io::StageClock clock;
  io::StagedDirectory staged(package, package::footprint(), &progress);
  RigInputs inputs = readInputs(capture, template_directory, options, progress);
  clock.book("reading meshes");

  const geometry::ExampleRig rig = fitRig(problemOf(inputs), options, progress);
  RigReport report = reportFit(capture, inputs, rig);
  noteWhatIsUnusual(report, rig.rigid_share, options.fit.head_motion, progress);
  inputs.subject.expressions = rig.examples;  // as the rig poses them: without the head's motion
  clock.book("fitting the rig");

  // Compressed within the staging directory: both appear together or not at all.
  CompressOptions compress = options.compress;
  compress.further_weight_maps = static_cast<int>(inputs.rig_template.names.size());  // a budget holds the shapes' too
  const fs::path compressed = staged.path() / ".compressed";                          // a name that no map has
  report.compress = compressCapture(capture, compressed, compress, device, progress);
  for (const fs::directory_entry& entry : fs::directory_iterator(compressed)) {
    fs::rename(entry.path(), staged.path() / entry.path().filename());
  }
  fs::remove(compressed);
  clock.book("compressing");

  const ShapeTextures textures = addShapeTextures(capture, staged.path(), inputs, rig, options, progress);
  reportTextures(textures, options, report);
  clock.book("textures of shapes");

  progress.stage("writing shapes", 0);
  const RigFace face = assembleFace(inputs.subject, inputs.rig_template, rig, options.eyes);
  report.vertices = static_cast<int>(face.neutral.positions.rows());
  report.parts = face.pieces;
  writeMeshes(inputs, face, rig, capture.name, options.compress.mesh, staged.path(), progress);
  io::writeTextFile(staged.path() / kRigFile, rigJson(report, inputs.subject.millimetresPerUnit()));
  clock.book("writing shapes");
  staged.commit();
  clock.book("publishing");
  report.seconds = clock.seconds();
  return report;
}

}  // namespace facezip
