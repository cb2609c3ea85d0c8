#include "refine/difference_target.hpp"

#include <fmt/format.h>

namespace facezip::compress {

cl::Event launchDifferenceTarget(device::DeviceContext& context, const WeightSpace& space, const CodedBuffers& buffers,
                                 int texture, device::KernelVariant variant) {
  const int lanes = context.resolve(variant) == device::KernelVariant::kGpu ? 1 : FACEZIP_VECTOR;
  const cl::Kernel kernel =
      context.kernel("difference_target.cl", "difference_target",
                     fmt::format("-D CHANNELS={} -D TEXTURES={} -D LANES={}", buffers.channels, space.textures, lanes));
  const int items = kTileTexels / lanes;
  return context.launch(
      kernel, device::WorkItems(items, buffers.tile_count).inGroupsOf(context.workGroupSize(kernel, toSize(items)), 1),
      buffers.factors, buffers.encoding, buffers.codes, texture);
}

}  // namespace facezip::compress
