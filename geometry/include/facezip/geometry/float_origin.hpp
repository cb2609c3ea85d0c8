// float_origin.hpp - what to take from the positions of a mesh before they are stored as floats.
#pragma once

#include <Eigen/Core>
#include <string>

namespace facezip::geometry {

/// Zero where floats hold the positions well. For a mesh that lies farther from the origin than kFarSizes times its
/// size, whose floats would round off more than 4e-6 of that, its middle, in whole units. positions  #V by 3, #V >= 1
Eigen::RowVector3d floatOrigin(const Eigen::MatrixX3d& positions);
inline constexpr double kFarSizes = 64.0;

/// A sentence for people. files  that hold the positions without their origin, which is not zero
std::string originNote(const Eigen::RowVector3d& origin, const std::string& files);

}  // namespace facezip::geometry
