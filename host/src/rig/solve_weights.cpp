// solve_weights.cpp - which weights of a rig make the meshes that were tracked.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "facezip/geometry/head_motion.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/geometry/topology.hpp"
#include "facezip/geometry/weight_solver.hpp"
#include "facezip/rig.hpp"
#include "io/staged_directory.hpp"
#include "rig/moving_head.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;

// Frames that are in memory at once.
constexpr std::size_t kBatch = 64;
// Frames that are looked at for a head that moves.
constexpr std::size_t kRigidEvery = 16;
// Sweeps over the frames of a smoothed clip.
constexpr int kSmoothingSweeps = 200;
constexpr double kSmoothingSettled = 1e-5;

struct LoadedRig {
  geometry::TriangleMesh skin;  ///< neutral of the captured topology
  std::string neutral_file;
  std::vector<Eigen::MatrixX3d> shapes;  ///< displacements of the skin
};

LoadedRig load(const Rig& rig) {
  const fs::path folder = rig.directory / "shapes";
  LoadedRig loaded;
  loaded.neutral_file = (folder / "neutral.obj").string();
  const geometry::TriangleMesh whole = geometry::readObj(loaded.neutral_file);
  if (whole.positions.rows() < rig.skin_vertices) {
    throw InputError({loaded.neutral_file, "vertices", fmt::format("at least {}", rig.skin_vertices),
                      fmt::format("{}", whole.positions.rows()), "make the package again"});
  }
  loaded.shapes.resize(rig.shapes.size());
  tbb::parallel_for(std::size_t{0}, rig.shapes.size(), [&](std::size_t m) {
    const std::string file = (folder / (rig.shapes[m] + ".obj")).string();
    const geometry::TriangleMesh shape = geometry::readObj(file);
    geometry::requireSameTopology(whole, loaded.neutral_file, shape, file);
    loaded.shapes[m] = (shape.positions - whole.positions).topRows(rig.skin_vertices);
  });
  // Parts beyond the skin come last.
  Eigen::Index triangles = whole.triangles.rows();
  while (triangles > 0 && whole.triangles.row(triangles - 1).maxCoeff() >= rig.skin_vertices) --triangles;
  loaded.skin.positions = whole.positions.topRows(rig.skin_vertices);
  loaded.skin.triangles = whole.triangles.topRows(triangles);
  loaded.skin.polygons.assign(whole.polygons.begin(),
                              whole.polygons.begin() + std::min(std::ssize(whole.polygons), triangles));
  return loaded;
}

class ClipSolver {
 public:
  ClipSolver(const Rig& rig, const LoadedRig& loaded, const SolveWeightsOptions& options)
      : rig_(rig), options_(options), solver_(loaded.skin.positions, loaded.shapes) {}

  struct Frame {
    Eigen::VectorXd projected;  ///< B^T (mesh - neutral), without the head's motion
    Eigen::VectorXd weights;
    geometry::RigidShare rigid;  ///< of some frames
  };

  /// A frame by itself.
  Frame solve(const Eigen::MatrixX3d& mesh) const {
    if (options_.head_motion) {
      geometry::StabilisedMesh stabilised = stabiliser_.stabilise(mesh);
      return {std::move(stabilised.projected), std::move(stabilised.weights), {}};
    }
    Frame frame{solver_.project(mesh), {}, {}};
    frame.weights = solver_.solve(frame.projected, Eigen::VectorXd::Zero(solver_.shapes()), 0.0);
    return frame;
  }

  /// minimises  sum_f |B w_f - d_f|^2 + s mean|b|^2 sum_f |w_f - w_f+1|^2  over the clip, a frame at a time.
  void smooth(std::vector<Frame>& frames) const {
    if (options_.smoothing <= 0.0 || frames.size() < 2) return;
    for (int sweep = 0; sweep < kSmoothingSweeps; ++sweep) {
      double change = 0.0;
      for (std::size_t f = 0; f < frames.size(); ++f) {
        Eigen::VectorXd near = Eigen::VectorXd::Zero(solver_.shapes());
        double neighbours = 0.0;
        if (f > 0) near += frames[f - 1].weights, ++neighbours;
        if (f + 1 < frames.size()) near += frames[f + 1].weights, ++neighbours;
        const Eigen::VectorXd next =
            solver_.solve(frames[f].projected, near / neighbours, neighbours * options_.smoothing);
        change = std::max(change, (next - frames[f].weights).cwiseAbs().maxCoeff());
        frames[f].weights = next;
      }
      if (change < kSmoothingSettled) break;
    }
  }

  geometry::RigidShare rigidShare(const Eigen::MatrixX3d& mesh, const Eigen::VectorXd& weights) const {
    geometry::RigidShare share;
    share.add(solver_, solver_.pose(weights), mesh);
    return share;
  }

  RigResidual residual(const Eigen::MatrixX3d& mesh, const Eigen::VectorXd& weights) const {
    const geometry::Distances found =
        geometry::distancesBetween(solver_.pose(weights), options_.head_motion ? still(mesh, weights) : mesh);
    const double scale = rig_.millimetres_per_unit;
    return {scale * found.mean, scale * found.percentile_99, scale * found.largest};
  }

 private:
  Eigen::MatrixX3d still(const Eigen::MatrixX3d& mesh, const Eigen::VectorXd& weights) const {
    return geometry::undo(solver_.headMotion(solver_.pose(weights), mesh), mesh);
  }

  const Rig& rig_;
  const SolveWeightsOptions& options_;
  geometry::WeightSolver solver_;
  geometry::HeadStabiliser stabiliser_{solver_};
};

/// Root mean square distance from the centre: the same wherever the head turns or goes.
double sizeOf(const Eigen::MatrixX3d& positions) {
  return std::sqrt((positions.rowwise() - positions.colwise().mean()).rowwise().squaredNorm().mean());
}

/// Meshes in another unit would be posed by weights of 0 and 1 alone.
void requireSameUnit(const Eigen::MatrixX3d& frame, const Eigen::MatrixX3d& neutral, const fs::path& file) {
  const double ratio = sizeOf(frame) / sizeOf(neutral);
  if (ratio > 1.0 / 3.0 && ratio < 3.0) return;
  throw InputError({file.string(), "", "a mesh of the size of the rig's neutral",
                    fmt::format("one {:.3g} times as large", ratio), "export it in the unit of the capture"});
}

Eigen::MatrixX3d readFrame(const fs::path& file, const LoadedRig& loaded) {
  geometry::TriangleMesh mesh = geometry::readObj(file);
  mesh.uv_triangles.resize(0, 3);  // trackers keep the order of vertices and faces, not always the UVs
  geometry::requireSameTopology(loaded.skin, loaded.neutral_file, mesh, file.string());
  requireSameUnit(mesh.positions, loaded.skin.positions, file);
  return mesh.positions;
}

bool hasName(const Rig& rig, const std::string& name) {
  const auto in = [&](const std::vector<std::string>& names) { return std::ranges::find(names, name) != names.end(); };
  return in(rig.shapes) || in(rig.package_expressions);
}

}  // namespace

SolvedClip solveWeights(const fs::path& package, const std::vector<fs::path>& meshes,
                        const SolveWeightsOptions& options, Progress& progress) {
  if (meshes.empty()) throw InputError({"meshes", "", "at least one OBJ file", "none", ""});
  if (!(options.smoothing >= 0.0 && options.smoothing <= 1e6)) {
    throw InputError({"--smoothing", "", "0 to 1e6", fmt::format("{}", options.smoothing), ""});
  }
  const Rig rig = openRig(package);
  const LoadedRig loaded = load(rig);
  const ClipSolver solver(rig, loaded, options);
  const auto begin = std::chrono::steady_clock::now();
  std::vector<ClipSolver::Frame> frames(meshes.size());
  SolvedClip clip;
  clip.shapes = rig.shapes;
  clip.numbered = !hasName(rig, "frame");
  clip.residuals.resize(meshes.size());
  const bool smoothed = options.smoothing > 0.0 && meshes.size() > 1;
  const auto forEachFrame = [&](const char* stage, const auto& visit) {
    progress.stage(stage, meshes.size());
    for (std::size_t first = 0; first < meshes.size(); first += kBatch) {
      progress.checkCancelled();
      const std::size_t last = std::min(first + kBatch, meshes.size());
      tbb::parallel_for(first, last, [&](std::size_t f) { visit(f, readFrame(meshes[f], loaded)); });
      progress.advance(last);
    }
  };
  forEachFrame("solving weights", [&](std::size_t f, const Eigen::MatrixX3d& mesh) {
    frames[f] = solver.solve(mesh);
    if (f % kRigidEvery == 0) frames[f].rigid = solver.rigidShare(mesh, frames[f].weights);
    if (!smoothed) clip.residuals[f] = solver.residual(mesh, frames[f].weights);
  });
  if (smoothed) {
    solver.smooth(frames);
    forEachFrame("measuring residuals", [&](std::size_t f, const Eigen::MatrixX3d& mesh) {
      clip.residuals[f] = solver.residual(mesh, frames[f].weights);
    });
  }
  for (const ClipSolver::Frame& frame : frames) clip.weights.emplace_back(frame.weights.begin(), frame.weights.end());
  if (!options.head_motion) {
    geometry::RigidShare rigid;
    for (const ClipSolver::Frame& frame : frames) rigid.add(frame.rigid);
    rig::noteMovingHead("the rig does not explain of the meshes", rigid.value(), clip.residuals, progress);
  }
  clip.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return clip;
}

void writeClip(const fs::path& file, const SolvedClip& clip, Progress* progress) {
  std::string text = fmt::format("{}{}\n", clip.numbered ? "frame," : "", fmt::join(clip.shapes, ","));
  for (std::size_t f = 0; f < clip.weights.size(); ++f) {
    if (clip.numbered) text += fmt::format("{},", f);
    text += fmt::format("{:.6g}\n", fmt::join(clip.weights[f], ","));
  }
  io::writeTextFileAtomically(file, text, progress);
}

}  // namespace facezip
