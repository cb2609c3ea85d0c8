#include "refine/weight_relax.hpp"

#include <fmt/format.h>

#include <cassert>

#include "io/counts.hpp"

namespace facezip::compress {

void launchWeightRelax(device::DeviceContext& context, const WeightRelaxLaunch& launch, device::KernelVariant variant) {
  assert(launch.smoothness > 0.0f && launch.trust > 0.0f);
  const WeightSpace& space = launch.window.space();
  const WindowRows& rows = launch.window.rows();
  const std::size_t lanes = context.resolve(variant) == device::KernelVariant::kGpu ? 1 : 16;
  const cl::Kernel kernel = context.kernel(
      "weight_relax.cl", "weight_relax",
      fmt::format("-D TEXTURES={} -D EXPRESSION_LANES={} -D LANES={}", space.textures, space.lanes(), lanes));
  const std::size_t items = space.lanes() / lanes;
  const std::size_t group = context.groupOf(kernel, items);
  for (int step = 0; step < 4 * launch.sweeps; ++step) {
    const int column = step % 2;
    // Colours by the parity of the grid's rows, so that a window's place does not change them.
    const int row = rows.free_begin + (rows.free_begin + step / 2) % 2;
    if (row >= rows.free_end || column >= space.columns) continue;
    context.launch(kernel,
                   device::WorkItems(items, divideUp(space.columns - column, 2), divideUp(rows.free_end - row, 2))
                       .inGroupsOf(group, 1, 1),
                   launch.system, launch.window.startBuffer(), launch.window.weightsBuffer(), column, row - rows.begin,
                   space.columns, rows.count(), launch.smoothness, launch.trust);
  }
}

}  // namespace facezip::compress
