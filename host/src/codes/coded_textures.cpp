#include "codes/coded_textures.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "codes/block_weights.hpp"
#include "refine/difference_settle.hpp"
#include "refine/difference_target.hpp"

namespace facezip::compress {
namespace {

/// What codes of a texture count: their steps squared, so that errors of all channels are in one unit.
std::array<float, 4> channelWeights(std::span<const TextureEncoding> encoding) {
  std::array<float, 4> weights{};
  float largest = 0.0f;
  for (std::size_t c = 0; c < encoding.size(); ++c) {
    weights[c] = encoding[c].scale * encoding[c].scale;
    largest = std::max(largest, weights[c]);
  }
  for (std::size_t c = 0; c < encoding.size(); ++c) weights[c] = largest > 0.0f ? weights[c] / largest : 1.0f;
  return weights;
}

float zeroCode(const TextureEncoding& e) { return e.scale > 0.0f ? std::round(-e.offset / e.scale) : 0.0f; }

}  // namespace

CodedTextures::CodedTextures(device::DeviceContext& context, const WeightSpace& space, TextureCoding coding,
                             blocks::Quality quality, bool keep_blocks)
    : context_(context),
      space_(space),
      coding_(std::move(coding)),
      keep_blocks_(keep_blocks),
      fit_(context, space),
      blocks_(toSize(space.textures)),
      block_weights_buffer_(context, "weights of texels in blocks", CL_MEM_READ_ONLY),
      encoding_(context, "encoding of the difference textures", CL_MEM_READ_ONLY),
      codes_(context, "codes of the difference textures"),
      textures_(context, "decoded difference textures"),
      errors_(context, "errors of the decoded difference textures") {
  assert(coding_.formats.size() == toSize(space.textures));
  const auto channels = toSize(coding_.channels);
  std::vector<cl_float2> encoding;
  for (const TextureEncoding& e : coding_.encoding) encoding.push_back({{e.scale, zeroCode(e)}});
  encoding_.upload(encoding);
  for (std::size_t i = 0; i < coding_.formats.size(); ++i) {
    blocks::EncoderOptions options;
    options.format = coding_.formats[i];
    options.channels = coding_.channels;
    options.quality = quality;
    options.channel_weights = channelWeights(std::span(coding_.encoding).subspan(i * channels, channels));
    coders_.push_back(makeTextureCoder(context, options));
  }
}

void CodedTextures::setTiles(const TileMasks& masks) {
  positions_ = masks.tiles;
  block_weights_ = blockWeights(masks);
  block_weights_buffer_.reserve(sizeof(float));
  if (!block_weights_.empty()) block_weights_buffer_.upload(block_weights_);
}

const cl::Buffer& CodedTextures::compute(const GridBand& band, const WeightWindow& window, float ridge) {
  assert(band.tiles.tileCount() == positions_.size() && band.shape.channels == coding_.channels);
  tile_count_ = positions_.size();
  const std::size_t planes = tile_count_ * toSize(space_.textures, coding_.channels, kTileTexels);
  codes_.reserve(planes * sizeof(float));
  textures_.reserve(planes * sizeof(float));
  const auto errors = toSize(settledErrors(context_, device::KernelVariant::kAuto));
  errors_.reserve(tile_count_ * errors * sizeof(cl_float2));
  const cl::Buffer& factors = fit_.computeFactors(band, window, ridge);
  const CodedTiles tiles{band.tiles, band.shape, positions_, block_weights_, block_weights_buffer_.buffer()};
  const CodedBuffers buffers{tile_count_, coding_.channels, factors, encoding_.buffer(), codes_.buffer()};
  for (int i = space_.textures - 1; i >= 0; --i) {
    launchDifferenceTarget(context_, space_, buffers, i);
    codeTexture(tiles, i);
  }
  launchDifferenceSettle(context_, space_, buffers, {band.tiles.texelWeights(), textures_.buffer(), errors_.buffer()},
                         ridge);
  return textures_.buffer();
}

void CodedTextures::codeTexture(const CodedTiles& tiles, int texture) {
  const auto channels = toSize(coding_.channels);
  std::vector<float> zero;
  for (std::size_t c = 0; c < channels; ++c) zero.push_back(zeroCode(coding_.encoding[toSize(texture) * channels + c]));
  std::vector<std::byte>& blocks = blocks_[toSize(texture)];
  if (keep_blocks_) {
    blocks.resize(blocks::blockBytes(coding_.formats[toSize(texture)], tiles.shape.width, tiles.shape.rows));
  }
  coders_[toSize(texture)]->code(tiles, {codes_.buffer(), space_.textures, texture}, zero, blocks);
}

std::vector<FitError> CodedTextures::errors() {
  return addTileErrors(errors_, tile_count_, toSize(settledErrors(context_, device::KernelVariant::kAuto)));
}

int blockRowStep(std::span<const blocks::BlockFormat> formats) {
  int step = kTileSide;
  for (const blocks::BlockFormat format : formats) step = std::lcm(step, blocks::infoOf(format).block_height);
  return step;
}

}  // namespace facezip::compress
