#include "refine/half_cell_gather.hpp"

#include <fmt/format.h>

namespace facezip::compress {

cl::Event launchHalfCellGather(device::DeviceContext& context, const HalfCellGatherLaunch& launch) {
  const WeightSpace& space = launch.window.space();
  const WindowRows& rows = launch.window.rows();
  const cl::Kernel kernel =
      context.kernel("half_cell_gather.cl", "half_cell_gather",
                     fmt::format("-D TEXTURES={} -D EXPRESSION_LANES={}", space.textures, space.lanes()));
  const std::size_t items = 1 + space.cellFloats() / FACEZIP_VECTOR;  // the blocks of a cell, then 16 sides each
  return context.launch(
      kernel, device::WorkItems(items, space.columns, rows.count()).inGroupsOf(context.groupOf(kernel, items), 1, 1),
      launch.halves, launch.system, launch.rows.first, launch.rows.count, rows.begin, space.rows,
      launch.rows.columns());
}

}  // namespace facezip::compress
