// skin_strain.hpp - how a deformation strains the skin, per vertex: what wrinkles, blood flow and their textures
// follow.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <utility>
#include <vector>

namespace facezip::geometry {

/// Measures deformations of one neutral. Edges count once however many triangles share them.
class SkinStrain {
 public:
  /// neutral  #V by 3, finite;  triangles  #T by 3
  SkinStrain(Eigen::MatrixX3d neutral, Eigen::MatrixX3i triangles);

  /// Mean length of the edges that meet at each vertex of `positions`, E(x) of Li et al. 2020, section 5.1, in the
  /// mesh's unit; 0 of vertices without edges. #V.
  Eigen::VectorXd ringLengths(const Eigen::MatrixX3d& positions) const;

  /// Root mean square of the relative change of length of the edges that meet at each vertex. #V, unitless. Edges
  /// without length in the neutral do not count.
  Eigen::VectorXd edgeChange(const Eigen::MatrixX3d& posed) const;

  /// Stretch and compression of the skin around each vertex. Row v holds two symmetric 3 by 3 tensors in space, each as
  /// (xx, yy, zz, sqrt2 yz, sqrt2 zx, sqrt2 xy): the part of the strain (stretch ratio - 1) above 0, then that below,
  /// as its absolute value. Products of rows are those of the tensors, whatever the coordinates. Averaged over the
  /// triangles of the vertex by area, then over `rounds` rings. #V by 12, unitless.
  Eigen::MatrixXd tensors(const Eigen::MatrixX3d& posed, int rounds) const;

  /// Averages a field (#V by k) over one-rings, `rounds` times; each spreads it by about one edge.
  Eigen::MatrixXd smoothed(Eigen::MatrixXd field, int rounds) const;

 private:
  Eigen::MatrixX3d neutral_;
  Eigen::MatrixX3i triangles_;
  std::vector<std::pair<int, int>> edges_;
  Eigen::SparseMatrix<double> average_;  ///< #V by #V: mean of a vertex and its neighbours
};

}  // namespace facezip::geometry
