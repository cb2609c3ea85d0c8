// model_fit.hpp - a linear model of faces (identities or expressions) and its rigid motion, fitted to points in space.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/deformation_transfer.hpp"
#include "facezip/geometry/surface_deformation.hpp"

namespace facezip::geometry {

/// Faces  mean + sum_k c_k mode_k,  low <= c_k <= high.
class LinearModel {
 public:
  /// modes  K displacements, #V by 3; K may be 0
  LinearModel(Eigen::MatrixX3d mean, const std::vector<Eigen::MatrixX3d>& modes, double low, double high);

  Eigen::Index modes() const { return basis_.cols(); }
  Eigen::Index vertices() const { return mean_.rows(); }
  double low() const { return low_; }
  double high() const { return high_; }
  const Eigen::MatrixX3d& mean() const { return mean_; }
  /// #V by 3.
  Eigen::MatrixX3d pose(const Eigen::VectorXd& coefficients) const;
  /// 3 rows, x y z of the vertex, by K.
  auto basisAt(int vertex) const { return basis_.middleRows<3>(3 * static_cast<Eigen::Index>(vertex)); }

 private:
  Eigen::MatrixX3d mean_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> basis_;  ///< 3 #V by K, vertex by vertex
  double low_, high_;
};

/// A face of the model where it stands in space.
struct ModelPose {
  Similarity motion;
  Eigen::VectorXd coefficients;

  Eigen::MatrixX3d place(const LinearModel& model) const { return motion.apply(model.pose(coefficients)); }
};

struct ModelFitOptions {
  double prior = 0.0;      ///< strength of |c|^2, in the unit of the targets: area times squared length
  bool fit_scale = false;  ///< of the motion, beside turn and shift
};

/// One step of Gauss and Newton from `pose`: motion and coefficients (within their bounds) that bring the model nearer
/// to the targets. Throws SolverError.
ModelPose stepModel(const LinearModel& model, const ModelPose& pose, const std::vector<PointTarget>& targets,
                    const ModelFitOptions& options);

}  // namespace facezip::geometry
