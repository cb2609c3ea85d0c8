#include "register/mesh_registration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "facezip/error.hpp"
#include "facezip/geometry/length.hpp"
#include "facezip/geometry/mesh_edges.hpp"

namespace facezip::registration {
namespace {
using geometry::LengthUnit;

// Heads differ in size by a fifth or so; units by factors of 2.5 and more.
constexpr double kLargestScale = 1.5;
constexpr double kLargestRms = 15.0;         // of landmarks, on another face than the template's
constexpr double kLargestExpression = 40.0;  // on the neutral: jaws open wide
constexpr double kIdentityBound = 3.0;       // standard deviations
// What must be true of a template that was fitted to a scan of a face.
constexpr double kFitReach = 10.0;
constexpr double kLeastMatched = 0.4;
constexpr double kLargestMean = 4.0;
constexpr double kClick = 1.0;  // that clicks are off, millimetres

geometry::MatchedSurface wholeSurface(const Eigen::MatrixX3i& triangles) {
  return {triangles, std::vector<bool>(static_cast<std::size_t>(triangles.rows()), true)};
}

void requireFit(const geometry::ScanResidual& residual, const PlacedScan& placed) {
  if (residual.matched >= kLeastMatched && residual.mean <= kLargestMean) return;
  throw InputError({placed.scan.file.string(), "scan", "a face that the template can be fitted to",
                    fmt::format("{:.0f} % of its surface within {:g} mm of the fitted template, {:.1f} mm on average",
                                100.0 * residual.matched, kFitReach, residual.mean),
                    "are landmarks and unit right, and is it a face?"});
}

geometry::ModelPose startOf(const geometry::LinearModel& model, const geometry::Similarity& motion) {
  return {motion, Eigen::VectorXd::Zero(model.modes())};
}

/// A model that fits the scan to a tenth of what clicks are off lies better along the skin, too, than they do.
double landmarkShare(const geometry::ScanResidual& model) {
  const double share = model.mean / kClick;
  return std::min(1.0, share * share);
}

std::vector<Eigen::MatrixX3d> scaled(const std::vector<Eigen::MatrixX3d>& displacements, double scale) {
  std::vector<Eigen::MatrixX3d> result;
  for (const Eigen::MatrixX3d& displacement : displacements) result.push_back(scale * displacement);
  return result;
}

}  // namespace

double unitOfTemplate(const RegistrationTemplate& source, const PlacedScan& placed) {
  const double scale = alignOrRefuse(placed, source.neutral.positions, false, kLargestRms).scale;
  double best = 0.0;
  for (const LengthUnit unit : {LengthUnit::kMillimetre, LengthUnit::kCentimetre, LengthUnit::kDecimetre,
                                LengthUnit::kMetre, LengthUnit::kInch, LengthUnit::kFoot}) {
    const double millimetres = 1000.0 * geometry::metresPerUnit(unit);
    if (best == 0.0 || std::abs(std::log(millimetres / scale)) < std::abs(std::log(best / scale))) best = millimetres;
  }
  if (std::max(best / scale, scale / best) <= kLargestScale) return best;
  throw InputError({source.neutral_file.string(), "template", "the size of the scanned head in mm, cm, m or in",
                    fmt::format("one of its units is {:.3g} mm of the scan", scale), "state the scans' unit: --unit"});
}

RegisteredSubject registerNeutral(const RegistrationTemplate& source, double millimetres_per_unit,
                                  const PlacedScan& placed, RegistrationStep last, Progress& progress) {
  const auto cancel = [&progress] { progress.checkCancelled(); };
  const Eigen::MatrixX3d generic = millimetres_per_unit * source.neutral.positions;
  const geometry::LinearModel identity(generic, scaled(source.identity, millimetres_per_unit), -kIdentityBound,
                                       kIdentityBound);
  const bool fit_scale = source.identity.empty();  // modes say how large heads are
  const geometry::MatchedSurface whole = wholeSurface(source.neutral.triangles);

  geometry::ModelPose pose = startOf(identity, alignOrRefuse(placed, generic, !fit_scale, kLargestRms));
  pose = geometry::poseFromLandmarks(identity, pose, placed.landmarks, {1.0, fit_scale}, 5);
  geometry::ModelRegistrationOptions fit;
  fit.fit = {0.3, fit_scale};
  fit.rounds = 30;
  if (last >= RegistrationStep::kModel) {
    pose = geometry::registerModel(identity, pose, placed.surface, whole, placed.landmarks, fit, cancel);
  }
  const Eigen::MatrixX3d posed = pose.place(identity);
  geometry::BentSurface surface{posed, whole, geometry::seenTriangles(posed, whole.triangles, placed.surface)};
  const geometry::ScanResidual model_residual = geometry::residualOf(surface, posed, placed.surface, kFitReach);
  if (last >= RegistrationStep::kModel) requireFit(model_residual, placed);

  geometry::NonRigidOptions bend;
  bend.landmark_share = landmarkShare(model_residual);
  const Eigen::MatrixX3d bent =
      last >= RegistrationStep::kBending
          ? geometry::registerNonRigid(surface, posed, placed.surface, placed.landmarks, bend, cancel)
          : posed;
  const geometry::ScanResidual residual = geometry::residualOf(surface, bent, placed.surface);
  const double scale = pose.motion.scale;
  pose.motion.scale = 1.0;
  const Eigen::MatrixX3d neutral = (bent.rowwise() - pose.motion.shift) * pose.motion.turn;
  surface.reference = neutral;
  surface.seen = geometry::seenTriangles(bent, whole.triangles, placed.surface);
  return {neutral,        pose.motion,
          surface,        geometry::LinearModel(neutral, scaled(source.shapes, scale * millimetres_per_unit), 0.0, 1.0),
          model_residual, residual,
          scale};
}

RegisteredExpression registerExpression(const RegisteredSubject& subject, const PlacedScan& placed,
                                        RegistrationStep last, Progress& progress) {
  const auto cancel = [&progress] { progress.checkCancelled(); };
  const geometry::LinearModel& model = subject.expressions;
  // The unit comes before how well landmarks fit, which is told in millimetres.
  const double scale = geometry::alignLandmarks(subject.neutral, placed.landmarks, false).scale;
  if (std::max(scale, 1.0 / scale) > kLargestScale) {
    throw InputError({placed.scan.file.string(), "scan", "the unit of the neutral's scan",
                      fmt::format("a face {:.3g} times as large", scale), "export all scans in one unit"});
  }
  alignOrRefuse(placed, subject.neutral, false, kLargestExpression);
  geometry::ModelPose pose = startOf(model, geometry::alignLandmarks(subject.neutral, placed.landmarks, true));
  pose = geometry::poseFromLandmarks(model, pose, placed.landmarks, {2.0, false}, 8);
  geometry::ModelRegistrationOptions fit;
  fit.fit = {1.0, false};
  if (last >= RegistrationStep::kModel) {
    pose = geometry::registerModel(model, pose, placed.surface, subject.surface.matched, placed.landmarks, fit, cancel);
  }
  RegisteredExpression expression;
  const Eigen::MatrixX3d posed = pose.place(model);
  expression.model_residual = geometry::residualOf(subject.surface, posed, placed.surface, kFitReach);
  if (last >= RegistrationStep::kModel) requireFit(expression.model_residual, placed);
  geometry::NonRigidOptions bend;
  bend.first_length = 12.0;
  bend.last_length = 3.0;
  bend.steps = 4;
  bend.first_kernel = 2.0;
  bend.landmark_share = landmarkShare(expression.model_residual);
  expression.mesh =
      last >= RegistrationStep::kBending
          ? geometry::registerNonRigid(subject.surface, posed, placed.surface, placed.landmarks, bend, cancel)
          : posed;
  expression.residual = geometry::residualOf(subject.surface, expression.mesh, placed.surface);
  expression.pose = std::move(pose);
  return expression;
}

geometry::Similarity headMotionOf(const RegisteredSubject& subject, const geometry::ModelPose& pose,
                                  const Eigen::MatrixX3d& mesh) {
  const Eigen::VectorXd areas = geometry::vertexAreas(subject.neutral, subject.surface.matched.triangles);
  const Eigen::VectorXd used = areas.cwiseProduct(subject.surface.seenVertices());
  return geometry::refitMotion(subject.expressions, pose, mesh, used).motion;
}

}  // namespace facezip::registration
