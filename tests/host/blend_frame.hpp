// blend_frame.hpp - one frame, for tests that compare frames.
#pragma once

#include <cstddef>
#include <vector>

#include "facezip/blend.hpp"

namespace facezip::test {

inline std::vector<std::byte> blendFrame(Blender& blender, const Package& package, int map,
                                         const std::vector<float>& beta) {
  std::vector<std::byte> frame(package.maps()[static_cast<std::size_t>(map)].frameBytes());
  blender.setWeights(beta);
  blender.blend(map, frame);
  return frame;
}

}  // namespace facezip::test
