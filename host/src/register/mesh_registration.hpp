// mesh_registration.hpp - the neutral's and the expressions' meshes from scans. Lengths in millimetres.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/nonrigid_registration.hpp"
#include "facezip/registration.hpp"
#include "register/registration_template.hpp"
#include "register/scan_alignment.hpp"

namespace facezip::registration {

/// The subject: its neutral in the template's topology, and the template's shapes on it.
struct RegisteredSubject {
  Eigen::MatrixX3d neutral;           ///< as the template is turned, at the subject's size
  geometry::Similarity motion;        ///< rigid: takes `neutral` to the scan
  geometry::BentSurface surface;      ///< its reference is `neutral`
  geometry::LinearModel expressions;  ///< of `neutral`
  geometry::ScanResidual model_residual, residual;
  double scale = 1.0;  ///< of the subject beside the template
};

/// Landmarks, identity modes within three standard deviations (or the template as it is), then non-rigid.
/// millimetres_per_unit  of the template, found by landmarks: `unitOfTemplate()`
/// last                  the step that is done last
/// Throws InputError where the template does not come to lie on the scan; SolverError, Cancelled.
RegisteredSubject registerNeutral(const RegistrationTemplate& source, double millimetres_per_unit,
                                  const PlacedScan& placed, RegistrationStep last, Progress& progress);

/// Millimetres in the template's unit: the one of mm, cm, dm, m, in and ft that makes it as large as the scan, nearly.
/// Throws InputError as alignOrRefuse(), or where none does.
double unitOfTemplate(const RegistrationTemplate& source, const PlacedScan& placed);

struct RegisteredExpression {
  Eigen::MatrixX3d mesh;     ///< where the scan is
  geometry::ModelPose pose;  ///< of the subject's shapes, before the mesh was bent
  geometry::ScanResidual model_residual, residual;
};

/// Rigid motion and shapes by landmarks, then by closest points, then non-rigid.
/// Throws InputError, SolverError, Cancelled.
RegisteredExpression registerExpression(const RegisteredSubject& subject, const PlacedScan& placed,
                                        RegistrationStep last, Progress& progress);

/// The rigid motion of the head in an expression.
/// mesh  as registered, where the scan is
geometry::Similarity headMotionOf(const RegisteredSubject& subject, const geometry::ModelPose& pose,
                                  const Eigen::MatrixX3d& mesh);

}  // namespace facezip::registration
