#include "refine/half_cell_fit.hpp"

#include <fmt/format.h>

#include <cassert>

#include "io/counts.hpp"

namespace facezip::compress {

std::size_t halfCellEntries(const WeightSpace& space) {
  return toSize(FACEZIP_HALF_CELL_MATRIX(space.textures)) + space.cellFloats();
}

cl::Event launchHalfCellFit(device::DeviceContext& context, const HalfCellFitLaunch& launch) {
  assert(launch.ridge > 0.0f);
  const WeightSpace& space = launch.window.space();
  const cl::Kernel kernel = context.kernel("half_cell_fit.cl", "half_cell_fit",
                                           fmt::format("-D TEXTURES={} -D EXPRESSIONS={} -D EXPRESSION_LANES={}",
                                                       space.textures, space.expressions, space.lanes()));
  return context.launch(kernel, device::WorkItems(launch.rows.groups, launch.rows.count).inGroupsOf(1, 1), launch.grams,
                        launch.window.weightsBuffer(), launch.halves, launch.errors, launch.rows.first,
                        launch.window.rows().begin, space.columns, space.rows, launch.ridge);
}

}  // namespace facezip::compress
