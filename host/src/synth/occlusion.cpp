// Ambient occlusion by form factors between the disks of vertices, after M. Bunnell, "Dynamic Ambient Occlusion and
// Indirect Lighting", GPU Gems 2 (2005).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "synth/skin_state.hpp"

namespace facezip::synth {
namespace {

constexpr double kReach = 0.025;  // metres: folds, lips, lids and the sides of the nose, not the whole head

struct Disk {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double area = 0.0;
};

std::vector<Disk> makeDisks(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles) {
  std::vector<Disk> disks(static_cast<std::size_t>(positions.rows()));
  for (Eigen::Index v = 0; v < positions.rows(); ++v) disks[static_cast<std::size_t>(v)].centre = positions.row(v);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Eigen::Vector3d edge1 = positions.row(triangles(f, 1)) - positions.row(triangles(f, 0));
    const Eigen::Vector3d edge2 = positions.row(triangles(f, 2)) - positions.row(triangles(f, 0));
    const Eigen::Vector3d doubled_area = edge1.cross(edge2);
    for (const int corner : triangles.row(f)) {
      disks[static_cast<std::size_t>(corner)].normal += doubled_area;
      disks[static_cast<std::size_t>(corner)].area += doubled_area.norm() / 6.0;
    }
  }
  for (Disk& disk : disks) disk.normal.normalize();
  return disks;
}

/// Share of the light at `receiver` that `emitter` takes away.
double formFactor(const Disk& receiver, const Disk& emitter) {
  const Eigen::Vector3d offset = emitter.centre - receiver.centre;
  const double squared = offset.squaredNorm();
  if (squared > kReach * kReach || squared == 0.0) return 0.0;
  const double inverse = 1.0 / std::sqrt(squared);
  const double facing = receiver.normal.dot(offset) * inverse;
  if (facing <= 0.0) return 0.0;
  // Skin is seen from both of its sides: the back of a lip occludes as its front does.
  const double turned = std::abs(emitter.normal.dot(offset)) * inverse;
  const double fade = 1.0 - squared / (kReach * kReach);
  return fade * fade * facing * turned * emitter.area / (std::numbers::pi * squared + emitter.area);
}

/// Vertices in cubes of side kReach, so that a vertex meets only those of 27 cubes.
class DiskGrid {
 public:
  explicit DiskGrid(const std::vector<Disk>& disks) {
    for (const Disk& disk : disks) low_ = low_.cwiseMin(disk.centre);
    for (const Disk& disk : disks) size_ = size_.cwiseMax(cubeOf(disk.centre) + Eigen::Vector3i::Ones());
    cubes_.resize(static_cast<std::size_t>(size_.prod()));
    for (std::size_t v = 0; v < disks.size(); ++v) cubes_[indexOf(cubeOf(disks[v].centre))].push_back(v);
  }

  template <typename Visit>
  void visitNear(const Eigen::Vector3d& point, const Visit& visit) const {
    const Eigen::Vector3i first = (cubeOf(point) - Eigen::Vector3i::Ones()).cwiseMax(0);
    const Eigen::Vector3i last = (cubeOf(point) + Eigen::Vector3i::Ones()).cwiseMin(size_ - Eigen::Vector3i::Ones());
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) {
          for (const std::size_t v : cubes_[indexOf({x, y, z})]) visit(v);
        }
      }
    }
  }

 private:
  Eigen::Vector3i cubeOf(const Eigen::Vector3d& point) const { return ((point - low_) / kReach).cast<int>(); }
  std::size_t indexOf(const Eigen::Vector3i& cube) const {
    return static_cast<std::size_t>((cube.z() * size_.y() + cube.y()) * size_.x() + cube.x());
  }

  Eigen::Vector3d low_ = Eigen::Vector3d::Constant(1e9);
  Eigen::Vector3i size_ = Eigen::Vector3i::Ones();
  std::vector<std::vector<std::size_t>> cubes_;
};

}  // namespace

std::vector<double> ambientOpenness(const Eigen::MatrixX3d& positions, const Eigen::MatrixX3i& triangles) {
  const std::vector<Disk> disks = makeDisks(positions, triangles);
  const DiskGrid grid(disks);
  std::vector<double> openness(disks.size());
  for (std::size_t v = 0; v < disks.size(); ++v) {
    double taken = 0.0;
    grid.visitNear(disks[v].centre, [&](std::size_t other) { taken += formFactor(disks[v], disks[other]); });
    // Disks that hide each other are counted twice; the exponential keeps the sum within the light there is.
    openness[v] = std::exp(-taken);
  }
  return openness;
}

}  // namespace facezip::synth
