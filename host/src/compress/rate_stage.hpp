// rate_stage.hpp - the number of difference textures and the weight scale, where a target or a budget chooses them.
#pragma once

#include "compress/compression_state.hpp"

namespace facezip::compress {

/// Compresses with `point` from here on.
void takeRate(CompressionState& state, const RatePoint& point);

/// Takes the next point that is worth trying. Throws InputError where none is left.
void chooseRate(CompressionState& state);

/// True if the package that was written misses the target: the search then learns from it. False without a target.
bool missesTarget(CompressionState& state);

}  // namespace facezip::compress
