// flow_points.hpp - optical flow between textures as points of the mesh and where they lie on the scan.
#pragma once

#include <span>
#include <vector>

#include "facezip/geometry/skin_registration.hpp"
#include "flow/texture_flow.hpp"
#include "raster/uv_raster.hpp"

namespace facezip::registration {

/// Where the texels of a layout lie on a scan: #texels by 3, millimetres; NaN where nothing was seen.
using TexelPlaces = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// One point for each triangle whose texels' flow is believed: their mean, and the mean of where they flow to.
/// Flow is believed as far as flow::trustOf() says; not at all where one of the four texels around its
/// end was not seen, or where these lie apart on the scan, as across lips.
/// texels   [side][side], which triangle each shows
/// known    [side][side], of the picture the flow begins in; 0: not seen
/// texel    millimetres of skin that a texel is wide, on the whole
std::vector<geometry::SkinPoint> flowPoints(const flow::TextureFlow& flow, std::span<const raster::TexelSample> texels,
                                            std::span<const std::uint8_t> known, const TexelPlaces& places,
                                            int triangles, double texel);

}  // namespace facezip::registration
