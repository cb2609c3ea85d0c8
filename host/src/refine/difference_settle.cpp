#include "refine/difference_settle.hpp"

#include <fmt/format.h>

namespace facezip::compress {

int settledErrors(const device::DeviceContext& context, device::KernelVariant variant) {
  return kTileTexels / (context.resolve(variant) == device::KernelVariant::kGpu ? 1 : FACEZIP_VECTOR);
}

cl::Event launchDifferenceSettle(device::DeviceContext& context, const WeightSpace& space, const CodedBuffers& buffers,
                                 const SettledBuffers& settled, float ridge, device::KernelVariant variant) {
  const int items = settledErrors(context, variant);
  const cl::Kernel kernel = context.kernel(
      "difference_settle.cl", "difference_settle",
      fmt::format("-D CHANNELS={} -D TEXTURES={} -D LANES={}", buffers.channels, space.textures, kTileTexels / items));
  return context.launch(
      kernel, device::WorkItems(items, buffers.tile_count).inGroupsOf(context.workGroupSize(kernel, toSize(items)), 1),
      buffers.factors, buffers.encoding, buffers.codes, settled.texel_weights, settled.textures, settled.errors, ridge);
}

}  // namespace facezip::compress
