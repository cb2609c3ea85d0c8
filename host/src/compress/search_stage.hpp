// search_stage.hpp - weights before any fit: clusters of every mask and their place in the textures (FaceZip, Eq. 2 to
// 6), or the influences of compress and stretch maps.
#pragma once

#include "compress/compression_state.hpp"

namespace facezip::compress {

/// Sets the group's start, and the coefficients of its textures where there are clusters. Touches no texel.
/// Throws DeviceError, InputError (an expression without mesh, for influences), Cancelled.
void searchWeights(CompressionState& state, WeightGroup& group);

}  // namespace facezip::compress
