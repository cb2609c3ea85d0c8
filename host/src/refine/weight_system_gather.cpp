#include "refine/weight_system_gather.hpp"

#include <fmt/format.h>

namespace facezip::compress {

cl::Event launchWeightSystemGather(device::DeviceContext& context, const WeightSystemGatherLaunch& launch) {
  const GridBand& band = launch.band;
  const WeightSpace& space = launch.window.space();
  const WindowRows& rows = launch.window.rows();
  const std::size_t entries = space.systemEntries();
  const cl::Kernel kernel = context.kernel("weight_system_gather.cl", "weight_system_gather",
                                           fmt::format("-D ENTRIES={} -D WEIGHT_SCALE={}", entries, band.weight_scale));
  const std::size_t items = entries / FACEZIP_VECTOR;
  return context.launch(
      kernel, device::WorkItems(items, space.columns, rows.count()).inGroupsOf(context.groupOf(kernel, items), 1, 1),
      launch.tile_at, launch.partial, launch.system, band.shape.tileColumns(), band.shape.tileRows(), band.first_row,
      rows.begin, space.columns, space.rows, launch.metric_weight, static_cast<cl_int>(launch.keep));
}

}  // namespace facezip::compress
