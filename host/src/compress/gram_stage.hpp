// gram_stage.hpp - pass 1: all that the search needs of the texels (FaceZip, Eq. 2 to 4).
#pragma once

#include "compress/compression_state.hpp"

namespace facezip::compress {

/// Accumulates the Gram matrices of every group, counts covered texels, and shows the texels to the search of rates
/// where there is one. Throws what reading and the device throw, and Cancelled.
void accumulateGrams(CompressionState& state);

}  // namespace facezip::compress
