#include "evaluate/texel_errors.hpp"

#include <cassert>
#include <cmath>

#include "bands/covered_texels.hpp"

namespace facezip::evaluate {

void texelErrors(std::span<const float> decoded, std::span<const float> captured, int channels,
                 std::span<const std::uint32_t> texels, std::span<float> errors) {
  assert(decoded.size() == captured.size() && errors.size() == texels.size());
  const auto stride = static_cast<std::size_t>(channels);
  const float share = 1.0f / static_cast<float>(channels);
  compress::forEachChunk(texels.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t first = texels[i] * stride;
      float sum = 0.0f;
      for (std::size_t at = first; at < first + stride; ++at) {
        const float difference = decoded[at] - captured[at];
        sum += difference * difference;
      }
      errors[i] = std::sqrt(share * sum);
    }
  });
}

TexelErrors summarizeTexelErrors(const ErrorDistribution& errors) {
  const double rmse = errors.rootMeanSquare();
  TexelErrors summary{rmse, 20.0 * std::log10(255.0 / rmse), errors.quantile(0.99), errors.max(), {}};
  for (std::size_t i = 0; i < summary.beyond.size(); ++i) summary.beyond[i] = errors.beyond(TexelErrors::kNoticed[i]);
  return summary;
}

}  // namespace facezip::evaluate
