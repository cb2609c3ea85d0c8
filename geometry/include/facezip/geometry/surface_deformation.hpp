// surface_deformation.hpp - a mesh drawn towards points in space, smoothly: the Laplacian deformation behind
// non-rigid ICP and behind dense correspondences.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

namespace facezip::geometry {

/// How stiff a deformation is. Lengths, in the mesh's unit: structure much smaller than them is not followed. A length
/// L stands for the weight at which data of weight 1 per area and the term balance at a wavelength of 2 pi L.
struct Stiffness {
  double bending = 0.0;   ///< second order: bending^4 times the squared bend of displacements across edges
  double membrane = 0.0;  ///< first order: membrane^2 times the squared gradient of displacements
  double anchor = 0.0;    ///< zeroth order, unitless: squared displacements; holds what nothing else does
  /// #T, factor of the membrane term of each triangle; empty: 1. What no data hold bends linearly to anywhere under the
  /// second order alone.
  Eigen::VectorXd membrane_factor;
};

/// Draws a point of the mesh towards a target: (x - target)^T metric (x - target), x = sum_k barycentric_k vertex_k.
struct PointTarget {
  Eigen::RowVector3i vertices;
  Eigen::RowVector3d barycentric;
  Eigen::RowVector3d target;
  Eigen::Matrix3d metric;  ///< symmetric, positive semidefinite; of the unit of an area
};

/// Displacements u of a mesh that minimise
///   sum of point targets + bending^4 sum_e 3 / A_e |k_e u|^2 + membrane^2 sum_t f_t A_t |grad u|^2
///   + anchor sum_v A_v |u_v|^2
/// k_e are the cotangent weights of the two triangles of an interior edge and A_e their area (Bergou et al. 2006,
/// "Quadratic bending", 3.2): fields linear on a flat mesh cost nothing, at borders too.
/// The smooth part is factored once together with a usual density of data; any targets are then solved for by
/// conjugate gradients preconditioned with that.
class SurfaceDeformation {
 public:
  /// density  expected weight of targets per area, #V; 0 where there will be none
  /// Throws SolverError if the factorisation fails.
  SurfaceDeformation(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles, const Stiffness& stiffness,
                     const Eigen::VectorXd& density);

  /// rest       #V by 3: where nothing draws; the smoothness is of the displacement from there
  /// start      #V by 3: positions to start from, nearer the result than rest or not
  /// rounds     of conjugate gradients at the most; they stop at a relative residual of `tolerance`
  Eigen::MatrixX3d solve(const std::vector<PointTarget>& targets, const Eigen::MatrixX3d& rest,
                         const Eigen::MatrixX3d& start, int rounds = 30, double tolerance = 1e-3) const;

 private:
  Eigen::SparseMatrix<double> smooth_;  ///< #V by #V
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace facezip::geometry
