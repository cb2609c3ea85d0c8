// rig.cpp - from a capture and a template to an animatable face. Each stage is a step of its own file.
#include "facezip/rig.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "compress/stage_clock.hpp"
#include "facezip/package.hpp"
#include "package/footprint.hpp"
#include "package/safe_names.hpp"
#include "rig/moving_head.hpp"
#include "rig/rig_json.hpp"
#include "rig/rig_meshes.hpp"
#include "rig/rig_weights.hpp"
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
    if (const auto fault = package::nameFault(longer)) {
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

class Rigging {
 public:
  Rigging(const Capture& capture, const fs::path& template_directory, const fs::path& package,
          const RigOptions& options, const Device& device, Progress& progress)
      : capture_(capture),
        template_directory_(template_directory),
        options_(options),
        device_(device),
        progress_(progress),
        staged_(package, package::footprint(), &progress) {}

  RigReport run() {
    read();
    fit();
    // Compressed within the staging directory: both appear together or not at all.
    CompressOptions compress = options_.compress;
    compress.further_weight_maps = static_cast<int>(template_.names.size());  // a budget holds the shapes' too
    const fs::path compressed = staged_.path() / ".compressed";               // a name that no map has
    report_.compress = compressCapture(capture_, compressed, compress, device_, progress_);
    for (const fs::directory_entry& entry : fs::directory_iterator(compressed)) {
      fs::rename(entry.path(), staged_.path() / entry.path().filename());
    }
    fs::remove(compressed);
    clock_.book("compressing");
    solveTextures();
    writeMeshes();
    staged_.commit();
    clock_.book("publishing");
    report_.seconds = clock_.seconds();
    return report_;
  }

 private:
  void read() {
    if (options_.fit.iterations < 0 || options_.fit.iterations > 1000) {
      throw InputError({"--iterations", "", "0 to 1000", fmt::format("{}", options_.fit.iterations), ""});
    }
    if (options_.texture_damping && !(*options_.texture_damping > 0.0 && *options_.texture_damping <= 1e6)) {
      throw InputError(
          {"--texture-damping", "", "above 0 and at most 1e6", fmt::format("{}", *options_.texture_damping), ""});
    }
    progress_.stage("reading the template", 0);
    template_ = readTemplate(template_directory_);
    subject_ = readSubject(capture_, options_, progress_);
    requireSkin(template_, subject_.neutral, capture_.neutral_mesh.string());
    problem_.neutral = subject_.neutral.positions;
    problem_.triangles = subject_.neutral.triangles;
    const Eigen::Index skin = problem_.neutral.rows();
    problem_.template_neutral = template_.neutral.positions.topRows(skin);
    for (const Eigen::MatrixX3d& shape : template_.shapes) problem_.template_shapes.emplace_back(shape.topRows(skin));
    problem_.examples = subject_.expressions;
    if (!options_.guess.empty()) {
      problem_.guess = readGuess(options_.guess, capture_.expressions, template_.names);
    }
    report_.expressions = capture_.expressions;
    report_.shapes = template_.names;
    report_.package_expressions =
        packageNamesOf(capture_.expressions, template_.names, capture_.directory.string(), progress_);
    report_.skin_vertices = static_cast<int>(skin);
    clock_.book("reading meshes");
  }

  void fit() {
    progress_.stage("fitting the rig", static_cast<std::size_t>(options_.fit.iterations));
    rig_ = geometry::fitExampleRig(problem_, options_.fit, [this](int iteration) {
      progress_.checkCancelled();
      progress_.advance(static_cast<std::size_t>(iteration));
    });
    const double scale = subject_.millimetresPerUnit();
    report_.weights = rowsOf(rig_.weights);
    for (const auto& residual : rig_.residuals) report_.residuals.push_back(inMillimetres(residual, scale));
    for (const auto& residual : rig_.template_residuals) {
      report_.template_residuals.push_back(inMillimetres(residual, scale));
    }
    for (const double rms : rig_.convergence) report_.convergence.push_back(scale * rms);
    for (const geometry::Similarity& motion : rig_.head_motions) {
      report_.head_motions.push_back(headMotionOf(motion, problem_.neutral, scale));
    }
    subject_.expressions = rig_.examples;  // as the rig poses them: without the head's motion
    report_.transfer = rig_.transfer == geometry::ShapeTransfer::kGradients ? "deformation gradients" : "displacements";
    report_.shape_prior = rig_.shape_prior;
    report_.left_out_share = rig_.left_out_template > 0.0 ? rig_.left_out / rig_.left_out_template : 1.0;
    report_.degenerate_triangles = rig_.degenerate_triangles;
    for (std::size_t m = 0; m < report_.shapes.size(); ++m) {
      if (rig_.shapes[m].isZero(0.0)) {
        report_.still.push_back(report_.shapes[m]);
      } else if (rig_.weights.col(static_cast<Eigen::Index>(m)).maxCoeff() <= kSeen) {
        report_.unseen.push_back(report_.shapes[m]);
      }
    }
    noteWhatIsUnusual();
    clock_.book("fitting the rig");
  }

  void noteWhatIsUnusual() {
    if (!options_.fit.head_motion) {
      noteMovingHead("the template does not explain of the expressions", rig_.rigid_share, report_.template_residuals,
                     progress_);
    }
    if (4 * report_.expressions.size() < report_.shapes.size()) {
      progress_.note(fmt::format("{} shapes from {} expression{}: most of the rig is the template's",
                                 report_.shapes.size(), report_.expressions.size(),
                                 report_.expressions.size() == 1 ? "" : "s"));
    }
    if (!report_.unseen.empty()) {
      progress_.note(fmt::format("no expression shows {}: as the template has them", fmt::join(report_.unseen, ", ")));
    }
    if (!report_.still.empty()) {
      progress_.note(fmt::format("{}: the template's shape moves nothing", fmt::join(report_.still, ", ")));
    }
    if (report_.degenerate_triangles > 0) {
      progress_.note(fmt::format("{} triangles of the neutral have no area: their vertices follow their neighbours",
                                 report_.degenerate_triangles));
    }
  }

  void solveTextures() {
    const Package package = Package::open(staged_.path());
    const compress::Face face = compress::readFace(capture_, options_.compress.region);
    const PackageMaps maps = openPackageMaps(capture_, face, package);
    const SkinFeatures features(subject_.neutral, subject_.expressions, rig_);
    const ChosenSolve chosen = chooseSolve(options_, rig_.weights, features, maps, progress_);
    report_.texture_rank = rankOf(rig_.weights);
    if (report_.texture_rank < static_cast<int>(report_.expressions.size())) {
      progress_.note(
          fmt::format("the expressions' weights have rank {}, not {}: some repeat or combine others; of twins, "
                      "give one",
                      report_.texture_rank, report_.expressions.size()));
    }
    const double clamped = addShapeWeights(staged_.path(), report_.package_expressions, report_.shapes, chosen.solver,
                                           features, maps, progress_);
    if (clamped > kMuchClamped) {
      progress_.note(
          fmt::format("{:.1f} % of the shapes' weights lie beyond those of the captured expressions and are "
                      "clamped: the expressions hardly tell some shapes apart",
                      100.0 * clamped));
    }
    report_.texture_solve = options_.texture_solve == TextureSolve::kLocal    ? "local"
                            : options_.texture_solve == TextureSolve::kDamped ? "damped"
                                                                              : "pseudo-inverse";
    report_.texture_damping = options_.texture_solve == TextureSolve::kPseudoInverse ? 0.0 : chosen.solver.damping;
    report_.strain_share = chosen.solver.strain_share;
    report_.left_out_rmse = chosen.left_out_rmse;
    report_.left_out_nothing = chosen.left_out_nothing;
    clock_.book("textures of shapes");
  }

  void writeMeshes() {
    progress_.stage("writing shapes", 0);
    const RigFace face = assembleFace(subject_, template_, rig_);
    report_.vertices = static_cast<int>(face.neutral.positions.rows());
    report_.parts = face.parts;
    const Package package = Package::open(staged_.path());
    writeFace(staged_.path(), face, report_.shapes, capture_.name, geometry::metresPerUnit(subject_.unit),
              package.maps());
    if (options_.compress.mesh) {
      writePackageMesh(staged_.path(), subject_, rig_, report_.package_expressions, report_.shapes, capture_.name);
    }
    io::writeTextFile(staged_.path() / kRigFile, rigJson(report_, subject_.millimetresPerUnit()));
    clock_.book("writing shapes");
  }

  const Capture& capture_;
  const fs::path& template_directory_;
  const RigOptions& options_;
  const Device& device_;
  Progress& progress_;
  io::StagedDirectory staged_;
  compress::StageClock clock_;
  RigTemplate template_;
  RigSubject subject_;
  geometry::RigProblem problem_;
  geometry::ExampleRig rig_;
  RigReport report_;
};

}  // namespace

ProtectedPaths inputsOf(const Capture& capture, const fs::path& template_directory, const RigOptions& options) {
  return inputsOf(capture, options.compress)
      .add(template_directory, "the template that is read")
      .addFile(options.guess, "the weights that are read");
}

RigReport rigCapture(const Capture& capture, const fs::path& template_directory, const fs::path& package,
                     const RigOptions& options, const Device& device, Progress& progress) {
  inputsOf(capture, template_directory, options).requireApartFromFolder(package);
  return Rigging(capture, template_directory, package, options, device, progress).run();
}

}  // namespace facezip
