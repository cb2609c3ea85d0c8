// registration_picture.hpp - what a registration looks like, drawn without a device.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "image/image_file.hpp"
#include "register/texture_baking.hpp"

namespace facezip::registration {

/// Where registered meshes are looked at from: before the middle of the region, so that it fills the picture.
struct FrontView {
  Eigen::Matrix<double, 2, 3> axes;  ///< to the right and up, in pixels for each millimetre
  Eigen::RowVector3d towards;        ///< of length 1, to who looks
  Eigen::RowVector2d corner;         ///< of the picture, in pixels along the axes
};

/// layout     its triangles
/// positions  #V by 3, of the neutral; up is +y
/// region     triangles that fill the picture
FrontView frontOf(const geometry::TriangleMesh& layout, const Eigen::MatrixX3d& positions,
                  const std::vector<int>& region);

/// Distance at which the false colour of the second picture is brightest, in millimetres.
inline constexpr double kBrightest = 1.0;
inline constexpr int kPictureSide = 400;

/// Three pictures side by side, 8-bit RGB, 3 kPictureSide by kPictureSide: the mesh with the edges of its faces; its
/// distances from the scan, black to yellow at kBrightest, grey where the scan shows nothing; its texture.
/// positions  #V by 3, upright as the neutral; distances  #V in millimetres, NaN: nothing shown
image::Image pictureOf(const FrontView& view, const geometry::TriangleMesh& layout, const Eigen::MatrixX3d& positions,
                       const std::vector<float>& distances, const BakedTexture& texture);

}  // namespace facezip::registration
