// part_transfer.hpp - eyes, teeth and lashes of a template follow the subject's skin (Li et al. 2020, section 6).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace facezip::geometry {

/// The template beyond the captured skin: vertices from `skin` on.
struct PartProblem {
  Eigen::Index skin = 0;                          ///< vertices of the skin, the first of the template
  Eigen::MatrixX3i triangles;                     ///< of the whole template
  Eigen::MatrixX3d template_neutral;              ///< all vertices
  std::vector<Eigen::MatrixX3d> template_shapes;  ///< M positions of all vertices
  Eigen::MatrixX3d neutral;                       ///< skin by 3: the subject's
  std::vector<Eigen::MatrixX3d> transferred;      ///< M displacements: the template's shapes on the subject's skin
  std::vector<Eigen::MatrixX3d> shapes;           ///< M displacements: the subject's own
  /// Group of each vertex beyond the skin, counted from 0: what is placed as one. Empty: connectedParts().
  std::vector<int> groups;
  /// Of each group: does it lie on the skin, as lashes do? Then it bends with it. Empty: none does.
  std::vector<bool> on_skin;
};

struct Parts {
  Eigen::MatrixX3d neutral;              ///< vertices beyond the skin, on the subject
  std::vector<Eigen::MatrixX3d> shapes;  ///< M displacements of them
  Eigen::MatrixXd coefficients;          ///< M by M: of the template's shapes that explain each of the subject's
  int count = 0;                         ///< groups
};

/// Part of every vertex from `skin` to `vertices`, counted from 0, by the triangles between such vertices.
std::vector<int> connectedParts(Eigen::Index skin, Eigen::Index vertices, const Eigen::MatrixX3i& triangles);

/// Distance of each vertex of the template beyond the skin to the nearest vertex of the skin.
Eigen::VectorXd distancesToSkin(Eigen::Index skin, const Eigen::MatrixX3d& template_neutral);

/// Places each group by the similarity that takes the template's skin around it onto the subject's, and moves it with
/// the coefficients in [0, 1] of the template's shapes that best explain the subject's skin. Groups on the skin also
/// get what the skin beside them does beyond that, in the neutral and in every shape: the less the farther off it is.
Parts transferParts(const PartProblem& problem);

}  // namespace facezip::geometry
