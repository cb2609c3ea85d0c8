// blend_error.hpp - errors of blends of several expressions (Eq. 8), where captures have none to compare with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bands/tile_band.hpp"
#include "evaluate/error_distribution.hpp"
#include "facezip/evaluate.hpp"

namespace facezip::evaluate {

/// `count` weight vectors of N values: one to five different expressions at once, their weights uniform in (0, 1], then
/// scaled so that the sum is uniform in (0, 2]. The same seed gives the same vectors; the first do not depend on
/// `count`.
std::vector<std::vector<float>> randomWeightVectors(std::uint64_t seed, int count, int expressions);

/// The same blend of the captured textures, I_0 + sum_n beta_n Delta_n, at the covered texels; others are left alone.
/// samples  neutral, then expressions, as a MapBand has them
/// out      rows x width x channels values in units of 1/255
void blendCaptured(std::span<const std::byte> samples, const compress::BandShape& shape, std::span<const float> beta,
                   std::span<const std::uint32_t> texels, std::span<float> out);

/// errors      of each weight vector
/// weights     the vectors
/// expressions errors of each expression alone
BlendErrors summarizeBlendErrors(std::span<const ErrorDistribution> errors, std::span<const std::vector<float>> weights,
                                 std::span<const ErrorDistribution> expressions);

}  // namespace facezip::evaluate
