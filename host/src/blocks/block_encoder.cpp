#include "blocks/block_encoder.hpp"

#include "blocks/astc_encoder.hpp"
#include "blocks/bc_encoder.hpp"

namespace facezip::blocks {

std::unique_ptr<BlockEncoder> makeBlockEncoder(device::DeviceContext& context, const EncoderOptions& options) {
  if (isAstc(options.format)) return std::make_unique<AstcEncoder>(options);
  return std::make_unique<BcEncoder>(context, options);
}

}  // namespace facezip::blocks
