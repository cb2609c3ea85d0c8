// model_registration.hpp - a linear model of faces fitted to a scan: landmarks, then closest points. Lengths in
// millimetres.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/model_fit.hpp"
#include "facezip/geometry/scan_surface.hpp"
#include "facezip/geometry/surface_matching.hpp"

namespace facezip::geometry {

/// A point that somebody clicked: where on a scan a vertex of the template lies, give or take a millimetre or two.
struct Landmark {
  int vertex = 0;
  Eigen::RowVector3d position;
};

/// The similarity (or rigid motion) that takes the mesh's vertices onto the landmarks, those that disagree with the
/// rest by much more than a few millimetres discounted. landmarks  at least 3
Similarity alignLandmarks(const Eigen::MatrixX3d& mesh, const std::vector<Landmark>& landmarks, bool fixed_scale);

/// Motion and coefficients by landmarks alone, `rounds` steps from `start`.
ModelPose poseFromLandmarks(const LinearModel& model, ModelPose start, const std::vector<Landmark>& landmarks,
                            const ModelFitOptions& options, int rounds);

struct ModelRegistrationOptions {
  ModelFitOptions fit;
  int rounds = 25;
  double first_kernel = 5.0;      ///< of the robust weights (MatchOptions), at the start ...
  double last_kernel = 0.8;       ///< ... and from three quarters of the rounds on
  double landmark_weight = 20.0;  ///< square millimetres that a landmark stands for at first; a tenth of it at last
};

/// Motion and coefficients that bring the model onto a scan, from `start`: closest points, point to plane, robust.
/// surface  triangles of the model
/// round    called before each round, for progress; may be empty
ModelPose registerModel(const LinearModel& model, ModelPose start, const ScanSurface& scan,
                        const MatchedSurface& surface, const std::vector<Landmark>& landmarks,
                        const ModelRegistrationOptions& options, const std::function<void()>& round = {});

/// The motion of the head in a registered mesh: motion and coefficients refitted to it together, vertex by vertex, so
/// that what the model cannot do and what moves much do not drag the head along.
/// pose  where to begin
/// used  #V, weights of the vertices' areas; 0 for those that the scan did not show
ModelPose refitMotion(const LinearModel& model, ModelPose pose, const Eigen::MatrixX3d& mesh,
                      const Eigen::VectorXd& used);

}  // namespace facezip::geometry
