#include "refine/half_cell_gram.hpp"

#include <fmt/format.h>

#include "bands/difference.hpp"
#include "device/pooled_buffer.hpp"
#include "io/counts.hpp"

namespace facezip::compress {

std::size_t halfCellGramBytes(const HalfCellRows& rows, int expressions) {
  return toSize(rows.count, rows.columns()) * (toSize(expressions, expressions + 1) / 2) * sizeof(float);
}

cl::Event launchHalfCellGram(device::DeviceContext& context, const HalfCellGramLaunch& launch) {
  const GridBand& band = launch.band;
  device::requireBytes(context, band.differences, differenceBufferBytes(band.shape, band.tiles.tileCount()),
                       "differences of a band");
  const cl::Kernel kernel = context.kernel("half_cell_gram.cl", "half_cell_gram",
                                           fmt::format("{} -D EXPRESSIONS={} -D HALF={}", differenceDefines(band.shape),
                                                       band.shape.expressions, band.weight_scale / 2));
  return context.launch(kernel, device::WorkItems(launch.rows.groups, launch.rows.count).inGroupsOf(1, 1),
                        launch.tile_at, band.tiles.texelWeights(), band.differences, launch.grams,
                        band.shape.tileColumns(), band.shape.tileRows(), band.first_row, launch.rows.first,
                        launch.metric_weight, static_cast<cl_int>(launch.keep));
}

}  // namespace facezip::compress
