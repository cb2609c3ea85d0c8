// hole_filling.hpp - what a picture shows where nothing was seen.
#pragma once

#include <cstdint>
#include <span>

namespace facezip::registration {

/// Fills the texels that are not known smoothly from those that are: pull-push over a pyramid of means (Gortler et al.
/// 1996, "The Lumigraph", 3.4). Known texels keep their values; without any, all become 0.
/// values  [height][width][channels], finite
/// known   [height][width], 0: to be filled
void fillHoles(std::span<float> values, int channels, int width, int height, std::span<const std::uint8_t> known);

}  // namespace facezip::registration
