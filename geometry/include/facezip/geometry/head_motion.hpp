// head_motion.hpp - what of a mesh is the head's rigid motion, and what its expression.
#pragma once

#include <Eigen/Core>

#include "facezip/geometry/weight_solver.hpp"

namespace facezip::geometry {

/// A mesh without the head's motion.
struct StabilisedMesh {
  Similarity motion;          ///< rigid: takes `mesh` onto what was given
  Eigen::MatrixX3d mesh;      ///< what was given without the motion, #V by 3
  Eigen::VectorXd weights;    ///< M, in [0, 1], that pose the rig like it
  Eigen::VectorXd projected;  ///< M, WeightSolver::project() of it
};

/// Tells rigid motion from expression: weights and motion that pose a rig like a mesh, by turns (bounded least squares,
/// Umeyama's alignment), until the weights settle by 1e-5 or 20 rounds are over. Either turn lowers the squared
/// distance.
class HeadStabiliser {
 public:
  /// rig  is referred to, and has to stay
  explicit HeadStabiliser(const WeightSolver& rig);

  /// mesh  #V by 3 of the rig's vertices
  StabilisedMesh stabilise(const Eigen::MatrixX3d& mesh) const;

 private:
  const WeightSolver& rig_;
  double used_;                         ///< vertices that count; means are over these
  Eigen::RowVector3d neutral_centre_;   ///< mean
  Eigen::MatrixX3d shape_centres_;      ///< M by 3, means of the displacements
  Eigen::VectorXd neutral_projection_;  ///< M: B^T neutral
};

/// What a rigid motion explains of the squared distances between meshes and the poses of a rig. Where weights cannot
/// follow because the head moves it is most of it.
class RigidShare {
 public:
  void add(const WeightSolver& rig, const Eigen::MatrixX3d& posed, const Eigen::MatrixX3d& mesh);
  void add(const RigidShare& other);
  /// In [0, 1]; 0 of nothing.
  double value() const;

 private:
  double squares_ = 0.0;
  double without_motion_ = 0.0;
};

/// The mesh as it would be without the motion.
Eigen::MatrixX3d undo(const Similarity& motion, const Eigen::MatrixX3d& mesh);

}  // namespace facezip::geometry
