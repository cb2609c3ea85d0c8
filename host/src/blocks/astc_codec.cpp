#include "blocks/astc_codec.hpp"

#include <astcenc.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <type_traits>

#include "facezip/error.hpp"

namespace facezip::blocks {
namespace {

void require(astcenc_error code, const char* step) {
  if (code != ASTCENC_SUCCESS) throw Error(fmt::format("{} (libastcenc): {}", step, astcenc_get_error_string(code)));
}

astcenc_swizzle storedAs(int channels) {
  switch (channels) {
    case 1:
      return {ASTCENC_SWZ_R, ASTCENC_SWZ_R, ASTCENC_SWZ_R, ASTCENC_SWZ_1};
    case 2:
      return {ASTCENC_SWZ_R, ASTCENC_SWZ_R, ASTCENC_SWZ_R, ASTCENC_SWZ_G};
    case 3:
      return {ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_1};
    default:
      return {ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};
  }
}

astcenc_swizzle readAs(int channels) {
  if (channels == 2) return {ASTCENC_SWZ_R, ASTCENC_SWZ_A, ASTCENC_SWZ_0, ASTCENC_SWZ_1};
  return {ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};
}

/// Weights of what is stored: a channel that is there three times counts once.
void setWeights(const std::array<float, 4>& weights, int channels, astcenc_config& config) {
  if (channels <= 2) {
    config.cw_r_weight = config.cw_g_weight = config.cw_b_weight = weights[0] / 3.0f;
    config.cw_a_weight = channels == 2 ? weights[1] : 0.0f;
  } else {
    config.cw_r_weight = weights[0];
    config.cw_g_weight = weights[1];
    config.cw_b_weight = weights[2];
    config.cw_a_weight = channels == 4 ? weights[3] : 0.0f;
  }
}

}  // namespace

AstcCodec::AstcCodec(BlockFormat format, int channels, const AstcEffort& effort,
                     const std::array<float, 4>& channel_weights, unsigned flags)
    : format_(format),
      channels_(channels),
      threads_(static_cast<unsigned>(std::max(1, tbb::this_task_arena::max_concurrency()))),
      context_(nullptr, astcenc_context_free) {
  const BlockFormatInfo& info = infoOf(format);
  astcenc_config config{};
  require(astcenc_config_init(ASTCENC_PRF_LDR, static_cast<unsigned>(info.block_width),
                              static_cast<unsigned>(info.block_height), 1, effort.search, flags, &config),
          "choosing how to code ASTC");
  setWeights(channel_weights, channels, config);
  if (effort.enough) config.tune_db_limit = 20.0f * std::log10(255.0f / std::max(*effort.enough, 1e-3f));
  if (effort.plain) config.tune_partition_count_limit = config.tune_candidate_limit = config.tune_refinement_limit = 1;
  astcenc_context* context = nullptr;
  require(astcenc_context_alloc(&config, threads_, &context), "starting to code ASTC");
  context_.reset(context);
}

AstcCodec::AstcCodec(BlockFormat format, int channels, const AstcEffort& effort,
                     const std::array<float, 4>& channel_weights)
    : AstcCodec(format, channels, effort, channel_weights, ASTCENC_FLG_SELF_DECOMPRESS_ONLY) {}

AstcCodec::AstcCodec(BlockFormat format, int channels)
    : AstcCodec(format, channels, {}, {1.0f, 1.0f, 1.0f, 1.0f}, ASTCENC_FLG_DECOMPRESS_ONLY) {}

AstcCodec::~AstcCodec() = default;

template <typename Sample>
void AstcCodec::run(int width, int height, std::span<Sample> rgba, std::byte* blocks, const std::byte* source) {
  assert(rgba.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  if (width == 0 || height == 0) return;
  const std::size_t bytes = blockBytes(format_, width, height);
  void* slice = rgba.data();
  astcenc_image image{static_cast<unsigned>(width), static_cast<unsigned>(height), 1,
                      std::is_same_v<Sample, float> ? ASTCENC_TYPE_F32 : ASTCENC_TYPE_U8, &slice};
  const astcenc_swizzle swizzle = source == nullptr ? storedAs(channels_) : readAs(channels_);
  std::atomic<astcenc_error> worst = ASTCENC_SUCCESS;
  // Each call takes what work is left, so it does no harm where one thread makes several.
  tbb::parallel_for(
      0u, threads_, 1u,
      [&](unsigned thread) {
        const astcenc_error code =
            source == nullptr ? astcenc_compress_image(context_.get(), &image, &swizzle,
                                                       reinterpret_cast<std::uint8_t*>(blocks), bytes, thread)
                              : astcenc_decompress_image(context_.get(), reinterpret_cast<const std::uint8_t*>(source),
                                                         bytes, &image, &swizzle, thread);
        if (code != ASTCENC_SUCCESS) worst = code;
      },
      tbb::simple_partitioner());
  require(source == nullptr ? astcenc_compress_reset(context_.get()) : astcenc_decompress_reset(context_.get()),
          "finishing ASTC");
  require(worst, source == nullptr ? "coding ASTC" : "decoding ASTC");
}

void AstcCodec::compress(int width, int height, std::span<float> rgba, std::span<std::byte> blocks) {
  assert(blocks.size() == blockBytes(format_, width, height));
  run(width, height, rgba, blocks.data(), nullptr);
}

void AstcCodec::compress(int width, int height, std::span<std::uint8_t> rgba, std::span<std::byte> blocks) {
  assert(blocks.size() == blockBytes(format_, width, height));
  run(width, height, rgba, blocks.data(), nullptr);
}

void AstcCodec::decompress(int width, int height, std::span<const std::byte> blocks, std::span<float> rgba) {
  assert(blocks.size() == blockBytes(format_, width, height));
  run(width, height, rgba, nullptr, blocks.data());
  // Error blocks are NaN in floats, magenta in bytes.
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    if (std::isnan(rgba[i])) rgba[i] = channels_ > 2 && i % 4 == 1 ? 0.0f : 1.0f;
  }
}

void AstcCodec::decompress(int width, int height, std::span<const std::byte> blocks, std::span<std::uint8_t> rgba) {
  assert(blocks.size() == blockBytes(format_, width, height));
  run(width, height, rgba, nullptr, blocks.data());
}

}  // namespace facezip::blocks
