// astc_encoder.hpp - ASTC blocks by libastcenc, which knows weights of channels but none of texels.
#pragma once

#include <vector>

#include "blocks/astc_codec.hpp"
#include "blocks/block_encoder.hpp"

namespace facezip::blocks {

/// Texels without weight are filled in from their block's others. Better qualities then go on with blocks of uneven
/// weights as astc_uneven_blocks.hpp says, which lowers their weighted error with every turn.
class AstcEncoder final : public BlockEncoder {
 public:
  /// Throws InputError as makeBlockEncoder() does.
  explicit AstcEncoder(const EncoderOptions& options);

  void encode(const TexelRows& texels, std::span<std::byte> blocks, std::span<float> decoded) override;

 private:
  EncoderOptions options_;
  AstcCodec codec_;
  std::vector<float> rgba_;
  std::vector<std::uint8_t> rgba_bytes_;
};

}  // namespace facezip::blocks
