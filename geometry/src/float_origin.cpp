#include "facezip/geometry/float_origin.hpp"

#include <fmt/format.h>

namespace facezip::geometry {

Eigen::RowVector3d floatOrigin(const Eigen::MatrixX3d& positions) {
  const Eigen::RowVector3d least = positions.colwise().minCoeff(), most = positions.colwise().maxCoeff();
  const double farthest = least.cwiseAbs().cwiseMax(most.cwiseAbs()).maxCoeff();
  if (farthest <= kFarSizes * (most - least).norm()) return Eigen::RowVector3d::Zero();
  return (0.5 * (least + most)).array().round().matrix();
}

std::string originNote(const Eigen::RowVector3d& origin, const std::string& files) {
  return fmt::format(
      "the mesh lies far from the origin for its size, and floats would round it off: {} {} it moved by ({}, {}, {})",
      files, files.find(" and ") == std::string::npos ? "holds" : "hold", -origin[0], -origin[1], -origin[2]);
}

}  // namespace facezip::geometry
