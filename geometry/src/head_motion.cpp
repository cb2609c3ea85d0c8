#include "facezip/geometry/head_motion.hpp"

#include <algorithm>

namespace facezip::geometry {
namespace {

constexpr int kRounds = 20;  // most heads need three
constexpr double kSettled = 1e-5;

}  // namespace

StilledMesh stillHead(const WeightSolver& rig, const Eigen::MatrixX3d& mesh) {
  StilledMesh found;
  found.weights = Eigen::VectorXd::Zero(rig.shapes());
  for (int round = 0; round < kRounds; ++round) {
    found.motion = rig.headMotion(rig.pose(found.weights), mesh);
    found.mesh = undo(found.motion, mesh);
    const Eigen::VectorXd next = rig.solve(rig.project(found.mesh), found.weights, 0.0);
    const double change = (next - found.weights).cwiseAbs().maxCoeff();
    found.weights = next;
    if (change < kSettled) break;
  }
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
