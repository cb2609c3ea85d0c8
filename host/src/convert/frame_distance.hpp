// frame_distance.hpp - how far the frames of two packages of one face are apart.
#pragma once

#include "blend/band_blender.hpp"
#include "facezip/device.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "raster/texel_classes.hpp"

namespace facezip::convert {

/// A package as it is decoded.
struct DecodedPackage {
  const Package& package;
  const blend::WeightSets& weights;
};

/// Root mean square over all expressions, the channels of a map and its covered texels, in 1/255, before frames are
/// rounded; 0 where nothing is covered. Throws InputError, DeviceError, Cancelled.
double frameDistance(const DecodedPackage& a, const DecodedPackage& b, int map_index,
                     const raster::TexelClasses& classes, const Device& device, Progress& progress);

}  // namespace facezip::convert
