// surface_gradient.hpp - derivatives over the triangles of a mesh, and fields back from derivatives.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace facezip::geometry {

/// The derivative of fields that are linear on each triangle, along two orthonormal axes of the triangle. The gradient
/// of a displacement is what Sumner and Popovic's deformation gradient minus the identity does to the triangle's plane.
/// Triangles without area have a gradient of 0 and do not count.
class SurfaceGradient {
 public:
  /// positions  #V by 3, finite
  /// triangles  #T by 3, rows of positions
  SurfaceGradient(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles);

  Eigen::Index vertices() const { return operator_.cols(); }
  Eigen::Index triangles() const { return areas_.size(); }
  int degenerateTriangles() const { return degenerate_; }

  /// Derivatives of a field: row 2 t + a is along axis a of triangle t. field  #V by k; returns 2 #T by k.
  Eigen::MatrixXd of(const Eigen::Ref<const Eigen::MatrixXd>& field) const { return operator_ * field; }
  /// 2 #T by 3: the axes of every triangle, rows 2 t and 2 t + 1; zero where there is no area.
  const Eigen::MatrixX3d& axes() const { return axes_; }
  /// #T, in the square of the unit; 0 of degenerate triangles.
  const Eigen::VectorXd& areas() const { return areas_; }
  const Eigen::SparseMatrix<double>& matrix() const { return operator_; }

 private:
  Eigen::SparseMatrix<double> operator_;  ///< 2 #T by #V
  Eigen::MatrixX3d axes_;
  Eigen::VectorXd areas_;
  int degenerate_ = 0;
};

/// Fields whose derivatives are as wanted, and which stay near what they were:
///   minimise  sum_t area_t |grad d (t) - X_t|^2 + screening^-2 sum_v area_v |d_v - z_v|^2
/// One factorisation serves any number of fields. Its second term pins what derivatives leave open, the offset of each
/// connected part, and makes the system definite on any mesh.
class ScreenedPoisson {
 public:
  /// gradient   must outlive the solver
  /// screening  length, in the mesh's unit: structure much smaller than this follows the derivatives alone
  /// Throws SolverError if the factorisation fails.
  ScreenedPoisson(const SurfaceGradient& gradient, const Eigen::MatrixX3i& triangles, double screening);

  /// The right-hand side of wanted derivatives X, 2 #T by k. Returns #V by k.
  Eigen::MatrixXd divergence(const Eigen::Ref<const Eigen::MatrixXd>& wanted) const { return divergence_ * wanted; }
  /// divergence  of the wanted derivatives, #V by k;  near  values z, #V by k. Returns #V by k.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& divergence, const Eigen::Ref<const Eigen::MatrixXd>& near) const;

 private:
  Eigen::SparseMatrix<double> divergence_;  ///< #V by 2 #T: transposed gradient times area
  Eigen::VectorXd anchor_;                  ///< #V: weight of |d_v - z_v|^2
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace facezip::geometry
