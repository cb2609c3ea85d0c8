// texel_errors.hpp - errors of decoded texels.
#pragma once

#include <cstdint>
#include <span>

#include "evaluate/error_distribution.hpp"
#include "facezip/evaluate.hpp"

namespace facezip::evaluate {

/// errors[i] = root mean square over the channels of decoded - captured at texels[i]. Their root mean square over
/// texels is that over texels and channels. decoded, captured  interleaved values of a band, in units of 1/255 texels
/// indices as compress::coveredTexels() gives them; errors  as many
void texelErrors(std::span<const float> decoded, std::span<const float> captured, int channels,
                 std::span<const std::uint32_t> texels, std::span<float> errors);

TexelErrors summarizeTexelErrors(const ErrorDistribution& errors);

}  // namespace facezip::evaluate
