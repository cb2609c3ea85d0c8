// example_rig.hpp - the shapes of a template made the subject's own from a few captured expressions (Li, Weise, Pauly
// 2010, "Example-Based Facial Rigging").
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "facezip/geometry/head_motion.hpp"

namespace facezip::geometry {

/// A subject, and a template of the same triangles.
struct RigProblem {
  Eigen::MatrixX3d neutral;                       ///< #V by 3, of the subject
  Eigen::MatrixX3i triangles;                     ///< #T by 3
  Eigen::MatrixX3d template_neutral;              ///< #V by 3
  std::vector<Eigen::MatrixX3d> template_shapes;  ///< M positions, #V by 3
  std::vector<Eigen::MatrixX3d> examples;         ///< N positions of the subject, #V by 3, N >= 1
  Eigen::MatrixXd guess;  ///< N by M, weights in [0, 1] the examples are thought to have; 0 rows: none
};

/// How the template's shapes come onto the subject's neutral before they see an example.
enum class ShapeTransfer {
  kGradients,      ///< deformation transfer: a triangle does what the template's does (Sumner and Popovic 2004)
  kDisplacements,  ///< a vertex goes as far as the template's, turned and scaled as the whole neutral is
  kBest,           ///< whichever of the two poses the examples better
};

/// Schedules go from start to end in equal ratios.
struct ExampleRigOptions {
  int iterations = 10;  ///< of shapes and weights in turn, >= 0; 0: the transferred shapes with their weights
  /// beta of Li et al. (Eq. 5) at the end, closeness of gradients to the transferred shapes'; none: the one with which
  /// each example's gradients are predicted best from the others (0.03 for one or two)
  std::optional<double> shape_prior;
  double shape_prior_fall = 10.0;   ///< it starts so many times higher
  double weight_prior_start = 1.0;  ///< gamma (Eq. 8), of the mean squared length of a shape: weights stay where they
  double weight_prior_end = 0.3;    ///< began, which is a bounded fit of the transferred shapes ...
  double guess_prior = 3e-4;        ///< ... held to the guess by this much, of the same
  ShapeTransfer transfer = ShapeTransfer::kBest;
  double kappa = 0.1;  ///< of the closeness' own weights (Eq. 6)
  double theta = 2.0;
  bool head_motion = false;  ///< find the rigid motion of the head in each example and take it out
};

struct ExampleRig {
  std::vector<Eigen::MatrixX3d> shapes;                ///< M displacements from the neutral, #V by 3
  Eigen::MatrixXd weights;                             ///< N by M, in [0, 1]
  ShapeTransfer transfer = ShapeTransfer::kGradients;  ///< that was taken
  double gradients_rms = 0.0;                 ///< over all examples, of a bounded fit of shapes by deformation transfer
  double displacements_rms = 0.0;             ///< and of shapes by displacements
  std::vector<Eigen::MatrixX3d> transferred;  ///< the template's shapes on the subject, before they saw an example
  Eigen::MatrixXd transferred_weights;        ///< N by M: bounded fit of these
  std::vector<Distances> residuals;           ///< of each example as the rig poses it
  std::vector<Distances> template_residuals;  ///< as the transferred shapes pose it
  std::vector<double> convergence;            ///< rms over all examples, at the start and after each iteration
  std::vector<Similarity> head_motions;       ///< N, of each example; empty unless they are taken out
  std::vector<Eigen::MatrixX3d> examples;     ///< N, what the rig was fitted to: without these motions
  double rigid_share = 0.0;                   ///< of the squared distance that the transferred shapes leave: RigidShare
  double shape_prior = 0.0;                   ///< beta that was taken
  double left_out = 0.0;                      ///< error of the examples' gradients, each predicted from the others ...
  double left_out_template = 0.0;             ///< ... and of the transferred shapes alone
  int degenerate_triangles = 0;               ///< of the neutral; they follow their neighbours
};

/// Fits the rig. Vertices that a template shape does not move stay put in the subject's too.
/// step  called before each iteration with its number; may throw to stop
/// Throws InputError where counts do not agree or nothing can be fitted, SolverError.
ExampleRig fitExampleRig(const RigProblem& problem, const ExampleRigOptions& options,
                         const std::function<void(int)>& step = {});

}  // namespace facezip::geometry
