// colour_drift.hpp - how much brighter and in what colour a scan was lit than the neutral's.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "facezip/geometry/mesh.hpp"
#include "raster/uv_raster.hpp"
#include "register/texture_baking.hpp"

namespace facezip::registration {

/// The factor of every channel that takes the neutral's texture to the expression's on skin that is still: the median
/// over cells of 8 x 8 texels of the half that moved least, so that blushes and wrinkles elsewhere say nothing. A gain
/// of the light is one of encoded colours, too, as far as these are a power of it. 1 where too little is seen.
/// raster            of the layout that both textures are in
/// neutral, moved    positions of the neutral and of the expression, the head's motion taken out
std::vector<double> colourGains(const raster::UvRaster& raster, const geometry::TriangleMesh& mesh,
                                const Eigen::MatrixX3d& neutral, const Eigen::MatrixX3d& moved,
                                const BakedTexture& neutral_texture, const BakedTexture& texture);

/// Divides a texture by gains of its channels.
void takeOut(const std::vector<double>& gains, BakedTexture& texture);

}  // namespace facezip::registration
