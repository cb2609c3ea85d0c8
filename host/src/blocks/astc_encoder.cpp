#include "blocks/astc_encoder.hpp"

#include <algorithm>
#include <cassert>

#include "blocks/astc_uneven_blocks.hpp"

namespace facezip::blocks {
namespace {

int turns(Quality quality) { return quality == Quality::kFast ? 0 : quality == Quality::kNormal ? 1 : 3; }

/// Samples of `channels` channels in the first of four; floats get 1 for full scale.
template <typename Sample>
void toRgba(std::span<const Sample> samples, int channels, Sample scale, std::vector<Sample>& rgba) {
  const auto count = static_cast<std::size_t>(channels);
  rgba.assign(samples.size() / count * 4, Sample{});
  for (std::size_t p = 0; p < samples.size() / count; ++p) {
    for (std::size_t c = 0; c < count; ++c) rgba[4 * p + c] = static_cast<Sample>(samples[count * p + c] * scale);
  }
}

EncoderOptions checked(EncoderOptions options) {
  requireChannels(options.format, options.channels);
  for (std::size_t c = static_cast<std::size_t>(options.channels); c < 4; ++c) options.channel_weights[c] = 0.0f;
  return options;
}

}  // namespace

AstcEffort astcEffort(Quality quality) {
  // Skin is smooth: at its own limits libastcenc leaves a quarter more error than need be. docs/block_formats.md has
  // figures.
  if (quality == Quality::kFast) return {.search = 0.0f, .enough = std::nullopt, .plain = true};
  if (quality == Quality::kNormal) return {.search = 10.0f, .enough = 1.3f};
  return {.search = 60.0f, .enough = 0.8f};
}

AstcEncoder::AstcEncoder(const EncoderOptions& options)
    : options_(checked(options)),
      codec_(options_.format, options_.channels, options_.astc_effort.value_or(astcEffort(options_.quality)),
             options_.channel_weights) {}

void AstcEncoder::encode(const TexelRows& texels, std::span<std::byte> blocks, std::span<float> decoded) {
  assert(texels.channels == options_.channels);
  const auto* bytes = std::get_if<std::span<const std::uint8_t>>(&texels.samples);
  if (bytes != nullptr && texels.weights.empty()) {
    toRgba<std::uint8_t>(*bytes, texels.channels, 1, rgba_bytes_);
    codec_.compress(texels.width, texels.rows, std::span(rgba_bytes_), blocks);
  } else {
    if (bytes != nullptr) {
      const std::vector<float> floats(bytes->begin(), bytes->end());
      toRgba<float>(floats, texels.channels, 1.0f / 255.0f, rgba_);
    } else {
      toRgba<float>(std::get<std::span<const float>>(texels.samples), texels.channels, 1.0f / 255.0f, rgba_);
    }
    UnevenBlocks uneven(options_.format, texels.width, texels.rows, texels.weights, rgba_);
    uneven.fillGaps(rgba_);
    codec_.compress(texels.width, texels.rows, std::span(rgba_), blocks);
    for (int turn = 0; turn < turns(options_.quality); ++turn) uneven.improve(codec_, options_.channel_weights, blocks);
  }
  if (decoded.empty()) return;
  rgba_.resize(static_cast<std::size_t>(texels.width) * static_cast<std::size_t>(texels.rows) * 4);
  codec_.decompress(texels.width, texels.rows, blocks, std::span(rgba_));
  const auto count = static_cast<std::size_t>(texels.channels);
  for (std::size_t p = 0; p < rgba_.size() / 4; ++p) {
    for (std::size_t c = 0; c < count; ++c) decoded[count * p + c] = rgba_[4 * p + c] * 255.0f;
  }
}

}  // namespace facezip::blocks
