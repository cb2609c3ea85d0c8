// texture_solve.hpp - the weight maps of a rig's shapes from those of the captured expressions (FaceZip, Eq. 10 to 12).
//   W*_m = sum_n P_mn W_n,   where the rig poses expression n with weights B_nm.
// Eq. 11 takes P = B^+, which solves Eq. 10 exactly and amplifies noise: B is far from orthogonal. With a prior
// variance A_m of shape m's texture and noise of variance lambda, the most likely textures are P = A B^T (B A B^T +
// lambda I)^-1; where A is how far m strains the skin here, a wrinkle belongs to the shapes that can cause it.
// Expressions that strain the skin alike look alike too, whatever shapes they were made of: a second term of the
// prior's covariance says that.
//   K_nn' = sum_m A_m B_nm B_n'm + s E_n . E_n',   C_mn = A_m B_nm + s E*_m . E_n,   P = C (K + lambda I)^-1
// with E the stretch and compression of the skin in an expression, E* in a shape.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "facezip/rig.hpp"
#include "rig/skin_features.hpp"

namespace facezip::rig {

struct TextureSolver {
  TextureSolve method = TextureSolve::kLocal;
  Eigen::MatrixXd weights;    ///< B, N by M
  double damping = 0.3;       ///< lambda
  double strain_share = 0.0;  ///< s; kLocal
};

/// Rank of B: singular values above 1e-6 of the largest count (a complete orthogonal decomposition, which Eq. 11's
/// B^T (B B^T)^-1 equals where the rows of B are independent).
int rankOf(const Eigen::MatrixXd& weights);

/// P, M by N, of methods that are the same everywhere. Dependent expressions are no harm: of all textures that explain
/// them the smallest are taken.
Eigen::MatrixXd globalSolution(const TextureSolver& solver);

/// P at a point of the skin, kLocal.
Eigen::MatrixXd localSolution(const TextureSolver& solver, const PointFeatures& point);

/// Inner products of the expressions' differences in one cell, and what is known of its skin.
struct SolvedCell {
  PointFeatures point;
  Eigen::MatrixXd gram;  ///< N by N, (1/255)^2
};

struct LeftOut {
  double damping = 0.0;
  double strain_share = 0.0;
  double error = 0.0;    ///< sum over cells and expressions of squared errors, each predicted from the others
  double nothing = 0.0;  ///< of predicting no change
};

/// Chooses lambda and s so that each captured expression is predicted best from the others. Needs no texel: the error
/// of leaving n out is that of K's inverse (Rasmussen and Williams 2006, Eq. 5.12) on the Gram matrix.
/// damping  a lambda that is to be kept to
LeftOut leaveOneOut(const TextureSolver& solver, std::span<const SolvedCell> cells, std::optional<double> damping);

}  // namespace facezip::rig
