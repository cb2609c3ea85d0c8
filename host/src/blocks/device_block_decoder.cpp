#include "blocks/device_block_decoder.hpp"

#include <fmt/format.h>

#include <cassert>

#include "blocks/block_encoder.hpp"
#include "device/pooled_buffer.hpp"

namespace facezip::blocks {
namespace {

int formatNumber(BlockFormat format) {
  switch (format) {
    case BlockFormat::kBc1:
      return 1;
    case BlockFormat::kBc4:
      return 4;
    case BlockFormat::kBc5:
      return 5;
    default:
      return 7;
  }
}

}  // namespace

void decodeOnDevice(device::DeviceContext& context, BlockFormat format, int channels, const cl::Buffer& blocks,
                    const TexelLayout& layout, DecodedType type, const cl::Buffer& texels) {
  assert(!isAstc(format));
  requireChannels(format, channels);
  const KernelLayout places = kernelLayout(layout);
  if (places.blocks == 0) return;
  const bool bytes = type == DecodedType::kUint8;
  device::requireBytes(context, blocks, blockBytes(format, layout.width, layout.rows), "blocks");
  device::requireBytes(context, texels, layout.end(channels) * (bytes ? 1 : sizeof(float)), "decoded blocks");
  const std::string defines =
      fmt::format("-D FORMAT={} -D CHANNELS={} {}{}", formatNumber(format), channels,
                  bytes ? "-D TEXEL=uchar -D WHOLE" : "-D TEXEL=float", layout.tiled() ? " -D TILES" : "");
  const cl::Kernel kernel = context.kernel("block_decode.cl", "block_decode", defines);
  const std::size_t local = context.workGroupSize(kernel, 64);
  const std::size_t items = roundUp(std::size_t{places.blocks}, local);
  context.launch(kernel, device::WorkItems(items).inGroupsOf(local), places, layout.tiled() ? layout.tiles : blocks,
                 blocks, texels);
}

}  // namespace facezip::blocks
