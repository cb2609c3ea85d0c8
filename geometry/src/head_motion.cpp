#include "facezip/geometry/head_motion.hpp"

#include <algorithm>

namespace facezip::geometry {
namespace {

constexpr int kRounds = 20;  // most heads need three
constexpr double kSettled = 1e-5;

}  // namespace

HeadStabiliser::HeadStabiliser(const WeightSolver& rig)
    : rig_(rig), used_(rig.used().sum()), neutral_centre_(rig.used().transpose() * rig.neutral() / used_) {
  const Eigen::MatrixXd sums = rig.products(Eigen::MatrixX3d::Ones(rig.vertices(), 3));
  shape_centres_ = sums.leftCols<3>() / used_;
  const Eigen::MatrixXd with_neutral = rig.products(rig.neutral());
  neutral_projection_ = with_neutral.col(0) + with_neutral.col(4) + with_neutral.col(8);
}

// All that a round needs of the vertices are the products of the mesh's axes with the shapes' and the neutral's, which
// the motion turns: they are formed once for a mesh.
StabilisedMesh HeadStabiliser::stabilise(const Eigen::MatrixX3d& mesh) const {
  const Eigen::RowVector3d centre = rig_.used().transpose() * mesh / used_;
  const Eigen::MatrixX3d centred = mesh.rowwise() - centre;
  const Eigen::MatrixXd with_shapes = rig_.products(centred);
  const Eigen::Matrix3d with_neutral =
      (rig_.neutral().rowwise() - neutral_centre_).transpose() * rig_.used().asDiagonal() * centred;
  StabilisedMesh found;
  found.weights = Eigen::VectorXd::Zero(rig_.shapes());
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Matrix3d with_pose = with_neutral + (with_shapes.transpose() * found.weights).reshaped(3, 3);
    const Eigen::RowVector3d pose_centre = neutral_centre_ + found.weights.transpose() * shape_centres_;
    found.motion.turn = rotationFrom(with_pose.transpose());
    found.motion.shift = centre - pose_centre * found.motion.turn.transpose();
    // B^T of the mesh undone, (mesh - shift) turn = centred turn + pose_centre, less the neutral's.
    found.projected = with_shapes * found.motion.turn.transpose().reshaped() +
                      used_ * shape_centres_ * pose_centre.transpose() - neutral_projection_;
    const Eigen::VectorXd next = rig_.solve(found.projected, found.weights, 0.0);
    const double change = (next - found.weights).cwiseAbs().maxCoeff();
    found.weights = next;
    if (change < kSettled) break;
  }
  found.mesh = undo(found.motion, mesh);
  return found;
}

void RigidShare::add(const WeightSolver& rig, const Eigen::MatrixX3d& posed, const Eigen::MatrixX3d& mesh) {
  squares_ += (posed - mesh).squaredNorm();
  without_motion_ += (posed - undo(rig.headMotion(posed, mesh), mesh)).squaredNorm();
}

void RigidShare::add(const RigidShare& other) {
  squares_ += other.squares_;
  without_motion_ += other.without_motion_;
}

double RigidShare::value() const { return squares_ > 0.0 ? std::max(0.0, 1.0 - without_motion_ / squares_) : 0.0; }

Eigen::MatrixX3d undo(const Similarity& motion, const Eigen::MatrixX3d& mesh) {
  return (mesh.rowwise() - motion.shift) * motion.turn / motion.scale;
}

}  // namespace facezip::geometry
