// astc_codec.hpp - libastcenc, whose calls return codes and want every thread to enter them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "blocks/block_format.hpp"
#include "blocks/block_quality.hpp"

struct astcenc_context;
struct astcenc_swizzle;

namespace facezip::blocks {

/// Pictures have four interleaved channels, of which a texture of fewer uses the first; 1 is full scale of floats.
/// Blocks hold one channel as luminance, two as luminance and alpha: endpoints of no others cost bits.
class AstcCodec {
 public:
  /// For coding, and decoding what it coded.
  AstcCodec(BlockFormat format, int channels, const AstcEffort& effort, const std::array<float, 4>& channel_weights);
  /// For decoding any blocks.
  AstcCodec(BlockFormat format, int channels);
  ~AstcCodec();

  BlockFormat format() const { return format_; }

  /// blocks  exactly blockBytes(format, width, height)
  void compress(int width, int height, std::span<float> rgba, std::span<std::byte> blocks);
  void compress(int width, int height, std::span<std::uint8_t> rgba, std::span<std::byte> blocks);
  /// Error blocks decode to magenta, as on GPUs. Floats are those of halves, which is what GPUs decode to.
  void decompress(int width, int height, std::span<const std::byte> blocks, std::span<float> rgba);
  void decompress(int width, int height, std::span<const std::byte> blocks, std::span<std::uint8_t> rgba);

 private:
  AstcCodec(BlockFormat format, int channels, const AstcEffort& effort, const std::array<float, 4>& channel_weights,
            unsigned flags);
  template <typename Sample>
  void run(int width, int height, std::span<Sample> rgba, std::byte* blocks, const std::byte* source);

  BlockFormat format_;
  int channels_;
  unsigned threads_;
  std::unique_ptr<astcenc_context, void (*)(astcenc_context*)> context_;
};

}  // namespace facezip::blocks
