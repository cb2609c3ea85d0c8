// shape_regression.hpp - how a person's own blendshapes differ from a template's, predicted from the neutral face
// alone: learned from many people who performed some expressions each.
//
// Subject s has shapes T_m + O_sm. With weights b_sem of the performance its expression e is displaced by
//   R_se = sum_m b_sem (T_m + O_sm) + noise.
// O is a Gaussian process over subjects and shapes, independent between shapes:
//   cov(O_sm, O_s'm) = a_m^2 (c + rho k(s, s') + (1 - rho) [s = s'])
// with a_m the length of the template's shape m in a region of the face, k linear in the principal components of the
// neutrals, and 1 - rho the share that no neutral tells. So everything that is known of all shapes follows in closed
// form from one system a region, of all expressions of all subjects; its mean for a new neutral is linear in it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "facezip/geometry/identity_basis.hpp"

namespace facezip::geometry {

/// What is learned from. All meshes have the same vertices and lie in one frame.
struct ShapeLibrary {
  std::vector<Eigen::MatrixX3d> template_shapes;        ///< M displacements, #V by 3
  std::vector<Eigen::MatrixX3d> neutrals;               ///< S >= 2, #V by 3
  std::vector<std::vector<Eigen::MatrixX3f>> examples;  ///< S times N displacements from the neutral, #V by 3
  Eigen::MatrixXd asked;                                ///< N by M in [0, 1]: what each expression was asked to be
};

/// What a regression was made with. Each was found by leaving subjects out.
struct RegressionChoice {
  int components = 0;      ///< of the neutrals' principal components
  double softness = 0.01;  ///< k counts a component of variance v by v / (v + softness v_1)
  double shared = 0.6;     ///< rho
  double noise = 0.2;      ///< of an expression, as a share of its displacement
  double left_out = 0.0;   ///< error of subjects' expressions predicted from the others ...
  double nothing = 0.0;    ///< ... and of the template alone, in the meshes' unit, root mean square
};

/// One shape's offsets: where the template moves, and nowhere else.
struct ShapeOffsets {
  std::vector<int> vertices;  ///< V_m, rising
  Eigen::MatrixXf rows;       ///< (1 + D) by 3 V_m: the mean, then what each score adds; x y z of each vertex together
};

struct ShapeRegression {
  IdentityBasis identity;             ///< D components
  std::vector<ShapeOffsets> offsets;  ///< M
  RegressionChoice choice;
  Eigen::MatrixXd weights;  ///< S N by M: how strongly each subject performed each expression, subject by subject

  /// Displacements of the offsets O_m for a neutral that lies as the mean does: M, #V by 3.
  /// most  scores are cut to [-most, most]
  std::vector<Eigen::MatrixX3d> predict(const Eigen::MatrixX3d& neutral, double most) const;
};

struct RegressionOptions {
  int rounds = 2;  ///< of performed weights and regression by turns, >= 1
};

/// Learns. step  called between pieces of work with a name; may throw to stop.
/// Throws InputError where counts do not agree or nothing can be learned: fewer than two subjects, neutrals that are
/// all the same, no expression of a shape.
ShapeRegression learnShapes(const ShapeLibrary& library, const RegressionOptions& options,
                            const std::function<void(const char*)>& step = {});

}  // namespace facezip::geometry
