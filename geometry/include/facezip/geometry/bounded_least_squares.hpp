// bounded_least_squares.hpp - small least squares problems whose unknowns have bounds.
#pragma once

#include <Eigen/Core>

namespace facezip::geometry {

/// minimises  1/2 x^T H x - g^T x  with  low <= x <= high  for every unknown: least squares |A x - b|^2 by its normal
/// equations H = A^T A, g = A^T b. An active set method (Stark and Parker, 1995): exact up to rounding, no tuning.
/// Unknowns that H says nothing about (a zero row) stay at the start.
/// hessian  M by M, symmetric, positive semidefinite
/// linear   M
/// start    M; what is closest to it is preferred where H does not decide; clamped to the bounds first
/// low      lower bounds, M or one for all, below high
/// Throws SolverError if the optimality conditions are not reached in 20 M + 100 steps.
Eigen::VectorXd solveBounded(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& linear,
                             const Eigen::VectorXd& start, const Eigen::VectorXd& low, const Eigen::VectorXd& high);
Eigen::VectorXd solveBounded(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& linear,
                             const Eigen::VectorXd& start, double low, double high);

}  // namespace facezip::geometry
