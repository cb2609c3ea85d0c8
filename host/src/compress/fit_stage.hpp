// fit_stage.hpp - pass 2: the weights that are written, and how far the difference textures reach that go with them.
#pragma once

#include <memory>

#include "compress/compression_state.hpp"

namespace facezip::compress {

/// Difference textures that follow from the weights as they are: by clusters (FaceZip, Eq. 5) or influences.
std::unique_ptr<TextureSource> directTextures(CompressionState& state, const WeightGroup& group);

/// The paper's method: takes the start's weights. Codes must hold how far their textures reach.
void keepWeights(CompressionState& state, WeightGroup& group);

/// The other methods: weights and difference textures fitted in turn.
/// most_sweeps  0: the start's weights, and the textures that suit them
void fitWeights(CompressionState& state, WeightGroup& group, int most_sweeps);

}  // namespace facezip::compress
