#include "blocks/block_encoder.hpp"

#include <fmt/format.h>

#include "blocks/astc_encoder.hpp"
#include "blocks/bc_encoder.hpp"
#include "facezip/error.hpp"

namespace facezip::blocks {

void requireChannels(BlockFormat format, int channels) {
  const BlockFormatInfo& info = infoOf(format);
  if (channels >= 1 && channels <= info.max_channels) return;
  throw InputError({std::string(info.name), "", fmt::format("textures of at most {} channels", info.max_channels),
                    fmt::format("{}", channels), "choose another format: bc7 and the astc formats store up to 4"});
}

std::unique_ptr<BlockEncoder> makeBlockEncoder(device::DeviceContext& context, const EncoderOptions& options) {
  if (isAstc(options.format)) return std::make_unique<AstcEncoder>(options);
  return std::make_unique<BcEncoder>(context, options);
}

}  // namespace facezip::blocks
