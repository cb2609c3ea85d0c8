// weight_solver.hpp - which blendshape weights pose a rig like a mesh.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/deformation_transfer.hpp"

namespace facezip::geometry {

/// How far two meshes lie apart, vertex by vertex, in their unit.
struct Distances {
  double rms = 0.0;
  double mean = 0.0;
  double percentile_99 = 0.0;
  double largest = 0.0;
};
Distances distancesBetween(const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b);

/// Weights in [0, 1] of a delta blendshape rig (FaceZip, Eq. 7) by bounded least squares on its vertices. What is the
/// same for every mesh is computed once.
class WeightSolver {
 public:
  /// neutral  #V by 3;  shapes  M displacements, #V by 3 each
  /// used     vertices that count, sorted; empty: all
  WeightSolver(Eigen::MatrixX3d neutral, const std::vector<Eigen::MatrixX3d>& shapes, std::vector<int> used = {});

  Eigen::Index shapes() const { return hessian_.rows(); }
  Eigen::Index vertices() const { return neutral_.rows(); }

  const Eigen::MatrixX3d& neutral() const { return neutral_; }
  /// #V: 1 for vertices that count, else 0.
  const Eigen::VectorXd& used() const { return mask_; }

  /// B^T B of the displacements, M by M, in the square of the unit.
  const Eigen::MatrixXd& hessian() const { return hessian_; }
  /// B^T (mesh - neutral), M.
  Eigen::VectorXd project(const Eigen::MatrixX3d& mesh) const;

  /// Row m: sum over the used vertices of b_m(v) points(v)^T, 3 by 3, column by column. points  #V by 3. M by 9.
  Eigen::MatrixXd products(const Eigen::MatrixX3d& points) const;

  /// minimises  |neutral + B w - mesh|^2 + strength mean_m |b_m|^2 |w - guess|^2  with w in [0, 1].
  /// strength  unitless, >= 0
  Eigen::VectorXd solve(const Eigen::VectorXd& projected, const Eigen::VectorXd& guess, double strength) const;

  /// neutral + B w, #V by 3, of all vertices.
  Eigen::MatrixX3d pose(const Eigen::VectorXd& weights) const;

  /// The rigid motion that takes the rig's pose onto the mesh, over the used vertices.
  Similarity headMotion(const Eigen::MatrixX3d& posed, const Eigen::MatrixX3d& mesh) const;

 private:
  Eigen::MatrixX3d neutral_;
  Eigen::MatrixXd basis_;  ///< 3 #V by M: column m is shape m, x of all vertices first
  Eigen::VectorXd mask_;   ///< #V: 1 for used vertices
  Eigen::MatrixXd hessian_;
};

}  // namespace facezip::geometry
