// block_encoder.hpp - textures as blocks, for loops that fit one texture to what others decode to: texels come as
// floats, since rounding them first would cost what the loop is for; every texel and channel has its weight; and what
// the blocks decode to comes back with them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <variant>

#include "blocks/block_format.hpp"
#include "blocks/block_quality.hpp"
#include "device/device_context.hpp"

namespace facezip::blocks {

/// Rows of texels of a picture in host memory. Units are codes, 0 to 255; floats may lie between them and beyond (they
/// are coded as what is nearest), and are finite.
struct TexelRows {
  int width = 0;
  int rows = 0;  ///< blocks at the right and at the bottom may hang over: what they have beyond is not looked at
  int channels = 0;
  /// rows x width x channels, channels interleaved
  std::variant<std::span<const float>, std::span<const std::uint8_t>> samples;
  /// rows x width, not below 0: what a texel's squared error counts. Empty: 1 everywhere. Blocks in which all are 0 are
  /// coded as if all were 1.
  std::span<const float> weights = {};
};

struct EncoderOptions {
  BlockFormat format = BlockFormat::kBc7;
  int channels = 3;  ///< of the texels, 1 to infoOf(format).max_channels
  Quality quality = Quality::kNormal;
  /// What the squared error of a channel counts: for a difference texture, the square of the channel's scale. Not below
  /// 0, and one of the first `channels` above.
  std::array<float, 4> channel_weights = {1.0f, 1.0f, 1.0f, 1.0f};
  /// ASTC only, in place of astcEffort(quality).
  std::optional<AstcEffort> astc_effort = {};
};

/// Codes rows of blocks. The same input gives the same bytes on one device.
class BlockEncoder {
 public:
  virtual ~BlockEncoder() = default;

  /// blocks   [block row][block column], exactly blockBytes(format, width, rows) bytes
  /// decoded  rows x width x channels, what they decode to, in code units; empty if not wanted
  /// Throws DeviceError.
  virtual void encode(const TexelRows& texels, std::span<std::byte> blocks, std::span<float> decoded) = 0;
};

/// BC formats are coded on the device of `context`, ASTC by libastcenc on all cores. Throws InputError when a texture
/// of so many channels cannot be stored in the format.
std::unique_ptr<BlockEncoder> makeBlockEncoder(device::DeviceContext& context, const EncoderOptions& options);

}  // namespace facezip::blocks
