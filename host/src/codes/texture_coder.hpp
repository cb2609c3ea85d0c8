// texture_coder.hpp - one difference texture of a band as blocks: its codes become what the blocks decode to.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "bands/device_tiles.hpp"
#include "bands/tile_band.hpp"
#include "blocks/block_encoder.hpp"
#include "device/device_context.hpp"

namespace facezip::compress {

/// The tiles of a band and what their texels count.
struct CodedTiles {
  const DeviceTiles& tiles;
  const BandShape& shape;
  std::span<const TilePosition> positions;  ///< the same tiles on the host
  std::span<const float> weights;           ///< [tile][256], blockWeights()
  const cl::Buffer& weights_buffer;         ///< the same on the device
};

/// Codes of difference textures, [tile][C][channel][256] float, of which one is coded.
struct TexturePlanes {
  const cl::Buffer& codes;
  int textures = 0;  ///< C
  int texture = 0;
};

class TextureCoder {
 public:
  virtual ~TextureCoder() = default;

  /// The texture's codes are replaced by what its blocks decode to. Rows of the band are whole rows of blocks, but for
  /// the image's last.
  /// blocks  [block row][block column] of the band, blocks of no tile hold `zero`; empty if not wanted
  /// zero    code of no difference, one a channel
  virtual void code(const CodedTiles& band, const TexturePlanes& planes, std::span<const float> zero,
                    std::span<std::byte> blocks) = 0;
};

/// BC formats are coded where the codes are, on the device; ASTC on the host. Throws InputError as
/// blocks::makeBlockEncoder() does.
std::unique_ptr<TextureCoder> makeTextureCoder(device::DeviceContext& context, const blocks::EncoderOptions& options);

}  // namespace facezip::compress
