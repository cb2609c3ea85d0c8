#include "refine/weight_system.hpp"

#include <fmt/format.h>

#include <cassert>

#include "io/counts.hpp"
#include "refine/half_cell_gather.hpp"
#include "refine/weight_relax.hpp"
#include "refine/weight_system_gather.hpp"

namespace facezip::compress {

std::size_t systemBytesOfTile(const WeightSpace& space, int weight_scale) {
  return toSize(FACEZIP_CELLS_OF_16(weight_scale), FACEZIP_CELLS_OF_16(weight_scale)) * space.systemEntries() *
         sizeof(float);
}

WeightSystem::WeightSystem(device::DeviceContext& context, const WeightSpace& space, device::KernelVariant variant)
    : context_(context),
      space_(space),
      gpu_(context.resolve(variant) == device::KernelVariant::kGpu),
      partial_(context, "equations of the tiles"),
      system_(context, "equations of the grid weights") {}

void WeightSystem::add(const GridBand& band, const cl::Buffer& tile_at, const cl::Buffer& textures,
                       const WeightWindow& window, double metric_weight) {
  sumTiles(band, textures);
  gather(band, tile_at, window, metric_weight);
}

void WeightSystem::sumTiles(const GridBand& band, const cl::Buffer& textures) {
  const std::size_t tiles = band.tiles.tileCount();
  partial_.reserve(tiles * systemBytesOfTile(space_, band.weight_scale));
  if (tiles == 0) return;
  const char* name = gpu_ ? "weight_system_gpu" : "weight_system";
  const cl::Kernel kernel =
      context_.kernel(fmt::format("{}.cl", name), name, gridDefines(band.shape, space_, band.weight_scale));
  const int cells = FACEZIP_CELLS_OF_16(band.weight_scale);
  const device::WorkItems items = gpu_ ? device::WorkItems(space_.systemEntries(), cells * cells, tiles)
                                             .inGroupsOf(context_.workGroupSize(kernel, kTileSide), 1, 1)
                                       : device::WorkItems(1, tiles).inGroupsOf(1, 1);
  context_.launch(kernel, items, band.tiles.positions(), band.tiles.texelWeights(), band.differences, textures,
                  partial_, band.first_row, space_.columns, space_.rows);
}

void WeightSystem::reserve(const WeightWindow& window) {
  system_.reserve(toSize(window.rows().count(), space_.columns) * space_.systemEntries() * sizeof(float));
}

void WeightSystem::gather(const GridBand& band, const cl::Buffer& tile_at, const WeightWindow& window,
                          double metric_weight) {
  reserve(window);
  launchWeightSystemGather(context_, {.band = band,
                                      .window = window,
                                      .metric_weight = static_cast<float>(metric_weight),
                                      .keep = !empty_,
                                      .tile_at = tile_at,
                                      .partial = partial_.buffer(),
                                      .system = system_.buffer()});
  empty_ = false;
}

void WeightSystem::gather(const HalfCells& halves, const WeightWindow& window) {
  reserve(window);
  launchHalfCellGather(
      context_, {.window = window, .rows = halves.rows(), .halves = halves.equations(), .system = system_.buffer()});
  empty_ = false;
}

void WeightSystem::relax(const WeightWindow& window, int sweeps, float smoothness, float trust) {
  assert(!empty_);
  launchWeightRelax(
      context_,
      {.window = window, .sweeps = sweeps, .smoothness = smoothness, .trust = trust, .system = system_.buffer()},
      gpu_ ? device::KernelVariant::kGpu : device::KernelVariant::kCpu);
}

}  // namespace facezip::compress
