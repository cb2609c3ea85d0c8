// skin_features.hpp - what the captured expressions and the rig's shapes do to the skin at a point of it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/example_rig.hpp"
#include "facezip/geometry/mesh.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::rig {

/// At one point of the skin.
struct PointFeatures {
  Eigen::VectorXd influence;    ///< M: how far each shape of the template strains the skin, 1 where any does most
  Eigen::MatrixXd of_examples;  ///< N by 12: stretch and compression of the skin in each expression
  Eigen::MatrixXd of_shapes;    ///< M by 12: in each shape of the rig
};

class SkinFeatures {
 public:
  /// mesh  the subject's neutral;  examples  N positions;  rig  fitted to them
  SkinFeatures(const geometry::TriangleMesh& mesh, const std::vector<Eigen::MatrixX3d>& examples,
               const geometry::ExampleRig& rig);

  PointFeatures at(const raster::TexelSample& sample) const;

 private:
  Eigen::MatrixX3i triangles_;
  Eigen::Index examples_, shapes_;
  /// #V rows: M influences, then 12 numbers of each expression, then of each shape. In units in which the mean square
  /// of an expression's 12 is 1.
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> vertices_;
};

}  // namespace facezip::rig
