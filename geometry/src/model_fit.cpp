#include "facezip/geometry/model_fit.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cassert>
#include <limits>

#include "facezip/geometry/bounded_least_squares.hpp"

namespace facezip::geometry {
namespace {

// Turn, shift, scale: the unknowns after the coefficients.
constexpr Eigen::Index kMotion = 7;

Eigen::Matrix3d turnBy(const Eigen::Vector3d& axis) {
  const double angle = axis.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

}  // namespace

LinearModel::LinearModel(Eigen::MatrixX3d mean, const std::vector<Eigen::MatrixX3d>& modes, double low, double high)
    : mean_(std::move(mean)),
      basis_(3 * mean_.rows(), static_cast<Eigen::Index>(modes.size())),
      low_(low),
      high_(high) {
  for (std::size_t m = 0; m < modes.size(); ++m) {
    assert(modes[m].rows() == mean_.rows());
    for (Eigen::Index v = 0; v < mean_.rows(); ++v) {
      basis_.block<3, 1>(3 * v, static_cast<Eigen::Index>(m)) = modes[m].row(v).transpose();
    }
  }
}

Eigen::MatrixX3d LinearModel::pose(const Eigen::VectorXd& coefficients) const {
  const Eigen::VectorXd moved = basis_ * coefficients;
  return mean_ + moved.reshaped(3, mean_.rows()).transpose();
}

ModelPose stepModel(const LinearModel& model, const ModelPose& pose, const std::vector<PointTarget>& targets,
                    const ModelFitOptions& options) {
  const Eigen::Index modes = model.modes();
  const Eigen::MatrixX3d placed = pose.place(model);
  const Eigen::RowVector3d centre = placed.colwise().mean();
  // The motion in units of the head's size, so that all unknowns are of one order.
  const double size = std::max(boundingDiagonal(placed), std::numeric_limits<double>::min());

  // Rows of sqrt(metric) (x - target), linear in the unknowns: absolute coefficients, increments of the motion.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows(
      3 * static_cast<Eigen::Index>(targets.size()), modes + kMotion);
  Eigen::VectorXd wanted(rows.rows());
  Eigen::Index row = 0;
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian(3, modes + kMotion);
  for (const PointTarget& target : targets) {
    jacobian.setZero();
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      if (target.barycentric[k] == 0.0) continue;
      point += target.barycentric[k] * placed.row(target.vertices[k]).transpose();
      jacobian.leftCols(modes) += target.barycentric[k] * model.basisAt(target.vertices[k]);
    }
    jacobian.leftCols(modes) = pose.motion.scale * pose.motion.turn * jacobian.leftCols(modes).eval();
    const Eigen::Vector3d arm = point - centre.transpose();
    Eigen::Matrix3d cross;  // of arm, so that turn x arm = -cross turn
    cross << 0, -arm.z(), arm.y(), arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0;
    jacobian.middleCols<3>(modes) = -cross;
    jacobian.middleCols<3>(modes + 3) = size * Eigen::Matrix3d::Identity();
    jacobian.col(modes + 6) = arm;
    const Eigen::Vector3d missing = target.target.transpose() - point + jacobian.leftCols(modes) * pose.coefficients;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(target.metric);
    for (int axis = 0; axis < 3; ++axis) {
      const double weight = axes.eigenvalues()[axis];
      if (weight <= 1e-12 * axes.eigenvalues()[2]) continue;
      const Eigen::RowVector3d along = std::sqrt(weight) * axes.eigenvectors().col(axis).transpose();
      rows.row(row) = along * jacobian;
      wanted[row++] = along * missing;
    }
  }
  const auto used = rows.topRows(row);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(modes + kMotion, modes + kMotion);
  hessian.selfadjointView<Eigen::Lower>().rankUpdate(used.transpose());
  hessian.triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
  Eigen::VectorXd linear = used.transpose() * wanted.head(row);
  hessian.diagonal().head(modes).array() += options.prior;
  if (!options.fit_scale) {
    hessian.row(modes + 6).setZero();
    hessian.col(modes + 6).setZero();
    linear[modes + 6] = 0.0;
  }
  Eigen::VectorXd start = Eigen::VectorXd::Zero(modes + kMotion);
  start.head(modes) = pose.coefficients;
  Eigen::VectorXd low = Eigen::VectorXd::Constant(modes + kMotion, -1.0);
  Eigen::VectorXd high = Eigen::VectorXd::Constant(modes + kMotion, 1.0);
  low.head(modes).setConstant(model.low());
  high.head(modes).setConstant(model.high());
  const Eigen::VectorXd solved = solveBounded(hessian, linear, start, low, high);

  ModelPose next;
  next.coefficients = solved.head(modes);
  const Eigen::Matrix3d turn = turnBy(solved.segment<3>(modes));
  const double scale = 1.0 + solved[modes + 6];
  next.motion.turn = turn * pose.motion.turn;
  next.motion.scale = scale * pose.motion.scale;
  next.motion.shift = scale * (pose.motion.shift - centre) * turn.transpose() + centre +
                      size * solved.segment<3>(modes + 3).transpose();
  return next;
}

}  // namespace facezip::geometry
