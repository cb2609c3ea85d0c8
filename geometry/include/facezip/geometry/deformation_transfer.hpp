// deformation_transfer.hpp - the shapes of one face on another (Sumner and Popovic 2004).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/surface_gradient.hpp"

namespace facezip::geometry {

/// What a source mesh does to its triangles when it takes a shape, as derivatives on a target of the same triangles:
/// row 2 t + a is (S_t - I) e_a with S_t the deformation gradient of the source's triangle (Sumner and Popovic 2004,
/// Eq. 4: edges and the scaled normal before and after) and e_a axis a of the target's triangle. Unitless.
/// neutral, shape  #V by 3, of the source
/// turn            rotation of the source's frame into the target's
/// Triangles without area in the source's neutral do nothing. Returns 2 #T by 3.
Eigen::MatrixX3d transferredGradient(const Eigen::MatrixX3d& neutral, const Eigen::MatrixX3d& shape,
                                     const Eigen::MatrixX3i& triangles, const SurfaceGradient& target,
                                     const Eigen::Matrix3d& turn);

/// The similarity  y = scale turn x + shift  that takes points onto others in the least squares sense (Umeyama 1991).
struct Similarity {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  double scale = 1.0;
  Eigen::RowVector3d shift = Eigen::RowVector3d::Zero();

  Eigen::MatrixX3d apply(const Eigen::MatrixX3d& points) const;
  /// The same without the shift: what becomes of displacements.
  Eigen::MatrixX3d applyToVectors(const Eigen::MatrixX3d& vectors) const;
};
/// The rotation R that takes centred points x onto centred points y best in the least squares sense (Umeyama 1991).
/// covariance  sum of y x^T over the points. Never a mirror image.
Eigen::Matrix3d rotationFrom(const Eigen::Matrix3d& covariance);

/// from, to  n by 3, n >= 1;  weights  n, >= 0 and not all 0, or empty for equal ones
/// fixed_scale  scale stays 1: a rigid motion
Similarity fitSimilarity(const Eigen::MatrixX3d& from, const Eigen::MatrixX3d& to, const Eigen::VectorXd& weights = {},
                         bool fixed_scale = false);

/// Vertices that a shape does not move: by no more than 1e-5 of the diagonal of the neutral's bounding box, which is
/// the rounding of OBJ files. displacement  #V by 3. Returns #V, 1 for what stays put, else 0.
Eigen::VectorXd stillVertices(const Eigen::MatrixX3d& neutral, const Eigen::MatrixX3d& displacement);

/// Length of the diagonal of the bounding box.
double boundingDiagonal(const Eigen::MatrixX3d& positions);

/// Displacements of the target whose gradients are as wanted, one after the other in columns. `still` vertices stay put
/// exactly and the rest follows: each round solves with the system of `solver` towards the last round's result with its
/// still vertices put back, so that one factorisation serves shapes whose still vertices differ.
/// wanted  2 #T by 3 M;  still  #V by M, 1 or 0;  start  #V by 3 M;  rounds  >= 1. Returns #V by 3 M.
Eigen::MatrixXd solveShapes(const ScreenedPoisson& solver, const Eigen::MatrixXd& wanted, const Eigen::MatrixXd& still,
                            const Eigen::MatrixXd& start, int rounds);

/// Deformation transfer of M shapes to a target mesh: factored once, M right-hand sides.
/// Returns displacements from the target's neutral, #V by 3 each.
std::vector<Eigen::MatrixX3d> transferShapes(const Eigen::MatrixX3d& source_neutral,
                                             const std::vector<Eigen::MatrixX3d>& source_shapes,
                                             const Eigen::MatrixX3d& target_neutral, const Eigen::MatrixX3i& triangles);

/// The same by displacements: a vertex goes as far as the source's, turned and scaled as the whole neutral is. What a
/// shape does not move (stillVertices()) stays put.
std::vector<Eigen::MatrixX3d> displacedShapes(const Eigen::MatrixX3d& source_neutral,
                                              const std::vector<Eigen::MatrixX3d>& source_shapes,
                                              const Eigen::MatrixX3d& target_neutral);

}  // namespace facezip::geometry
