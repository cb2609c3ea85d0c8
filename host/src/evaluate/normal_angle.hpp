// normal_angle.hpp - angles between captured and decoded normals.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "evaluate/error_distribution.hpp"
#include "facezip/evaluate.hpp"

namespace facezip::evaluate {

/// Whether a map holds normals: "normal" in its name, in any case, and 3 or 4 channels.
bool isNormalMap(const std::string& name, int channels);

/// angles[i] = angle in degrees, [0, 180], between the normals of `decoded` and `captured` at texels[i]. A normal is
/// the first three channels decoded as 2 v / 255 - 1 and brought to unit length, as a shader does; a vector shorter
/// than 1e-6 has no direction and counts as (0, 0, 1), the normal of the undisturbed surface. decoded, captured
/// interleaved values of a band, in units of 1/255; channels 3 or 4 texels             indices as
/// compress::coveredTexels() gives them; angles  as many
void normalAngles(std::span<const float> decoded, std::span<const float> captured, int channels,
                  std::span<const std::uint32_t> texels, std::span<float> angles);

NormalAngles summarizeNormalAngles(const ErrorDistribution& angles);

}  // namespace facezip::evaluate
