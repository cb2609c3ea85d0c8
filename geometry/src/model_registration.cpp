#include "facezip/geometry/model_registration.hpp"

#include <cassert>
#include <cmath>

namespace facezip::geometry {
namespace {

// Landmarks are a millimetre or two off, people's worst ones a centimetre.
constexpr double kLandmarkKernel = 3.0;
constexpr double kLandmarkFall = 0.1;  // of their weight, over the rounds
constexpr double kLeastCosine = 0.5;
constexpr double kReach = 20.0;
// Of the refit: residuals, and movement, beyond which vertices say little of the head.
constexpr double kStillResidual = 0.3;
constexpr double kStillMovement = 3.0;
constexpr int kStillRounds = 15;
constexpr double kStillPrior = 0.1;

/// Geman and McClure's weight: 1, a quarter at the kernel, 0 far off.
double robust(double distance, double kernel) {
  const double share = distance / kernel;
  return 1.0 / ((1.0 + share * share) * (1.0 + share * share));
}

PointTarget targetOf(int vertex, const Eigen::RowVector3d& position, double weight) {
  return {{vertex, vertex, vertex}, {1.0, 0.0, 0.0}, position, weight * Eigen::Matrix3d::Identity()};
}

void addLandmarks(const std::vector<Landmark>& landmarks, const Eigen::MatrixX3d& placed, double weight,
                  std::vector<PointTarget>& targets) {
  for (const Landmark& mark : landmarks) {
    const double distance = (mark.position - placed.row(mark.vertex)).norm();
    targets.push_back(targetOf(mark.vertex, mark.position, weight * robust(distance, kLandmarkKernel)));
  }
}

}  // namespace

Similarity alignLandmarks(const Eigen::MatrixX3d& mesh, const std::vector<Landmark>& landmarks, bool fixed_scale) {
  assert(landmarks.size() >= 3);
  const auto count = static_cast<Eigen::Index>(landmarks.size());
  Eigen::MatrixX3d from(count, 3), to(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Landmark& mark = landmarks[static_cast<std::size_t>(i)];
    from.row(i) = mesh.row(mark.vertex);
    to.row(i) = mark.position;
  }
  Similarity similarity = fitSimilarity(from, to, {}, fixed_scale);
  for (int round = 0; round < 10; ++round) {
    const Eigen::VectorXd distances = (similarity.apply(from) - to).rowwise().norm();
    // Another face than the template's misses by more than a click does: the kernel follows.
    const double kernel = std::max(kLandmarkKernel, 2.0 * distances.mean());
    similarity = fitSimilarity(from, to, distances.unaryExpr([&](double d) { return robust(d, kernel); }), fixed_scale);
  }
  return similarity;
}

ModelPose poseFromLandmarks(const LinearModel& model, ModelPose start, const std::vector<Landmark>& landmarks,
                            const ModelFitOptions& options, int rounds) {
  std::vector<PointTarget> targets;
  for (const Landmark& mark : landmarks) targets.push_back(targetOf(mark.vertex, mark.position, 1.0));
  for (int round = 0; round < rounds; ++round) start = stepModel(model, start, targets, options);
  return start;
}

ModelPose registerModel(const LinearModel& model, ModelPose pose, const ScanSurface& scan,
                        const MatchedSurface& surface, const std::vector<Landmark>& landmarks,
                        const ModelRegistrationOptions& options, const std::function<void()>& round_begins) {
  std::vector<int> hints;
  for (int round = 0; round < options.rounds; ++round) {
    if (round_begins) round_begins();
    const double share = options.rounds > 1 ? static_cast<double>(round) / (options.rounds - 1) : 1.0;
    const double kernel =
        options.first_kernel * std::pow(options.last_kernel / options.first_kernel, std::min(1.0, share * 4.0 / 3.0));
    const Eigen::MatrixX3d placed = pose.place(model);
    std::vector<PointTarget> targets =
        matchSurface(scan.points(), surface, placed, {kernel, kLeastCosine, kReach}, hints);
    addLandmarks(landmarks, placed, options.landmark_weight * std::pow(kLandmarkFall, share), targets);
    pose = stepModel(model, pose, targets, options.fit);
  }
  return pose;
}

ModelPose refitMotion(const LinearModel& model, ModelPose pose, const Eigen::MatrixX3d& mesh,
                      const Eigen::VectorXd& used) {
  assert(mesh.rows() == model.vertices() && used.size() == mesh.rows());
  for (int round = 0; round < kStillRounds; ++round) {
    const Eigen::MatrixX3d placed = pose.place(model);
    const Eigen::MatrixX3d moved = model.pose(pose.coefficients) - model.mean();
    std::vector<PointTarget> targets;
    for (Eigen::Index v = 0; v < mesh.rows(); ++v) {
      if (!(used[v] > 0.0)) continue;
      const double residual = (placed.row(v) - mesh.row(v)).norm() / kStillResidual;
      const double movement = moved.row(v).norm() / kStillMovement;
      const double weight = used[v] / ((1.0 + residual * residual) * (1.0 + movement * movement));
      targets.push_back(targetOf(static_cast<int>(v), mesh.row(v), weight));
    }
    pose = stepModel(model, pose, targets, {kStillPrior, false});
  }
  return pose;
}

}  // namespace facezip::geometry
