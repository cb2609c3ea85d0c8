#include "compress/refine/weight_system.hpp"

#include <fmt/format.h>

#include <cassert>

#include "compress/bands/difference.hpp"

namespace facezip::compress {
namespace {

int tilesAlong(int texels) { return (texels + kTileSide - 1) / kTileSide; }

/// Cells that 16 texels in a row interpolate between, at most: CELLS_OF_16 of kernels/cl/common.cl.
std::size_t cellsOf16(int weight_scale) { return static_cast<std::size_t>((14 + weight_scale) / weight_scale + 2); }

}  // namespace

std::size_t systemBytesOfTile(const WeightSpace& space, int weight_scale) {
  return cellsOf16(weight_scale) * cellsOf16(weight_scale) * space.systemEntries() * sizeof(float);
}

std::vector<int> tileLookup(const TileMasks& tiles, const BandShape& shape) {
  const int columns = tilesAlong(shape.width);
  std::vector<int> lookup(static_cast<std::size_t>(columns * tilesAlong(shape.rows)), -1);
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    lookup[static_cast<std::size_t>(tiles.tiles[t].y * columns + tiles.tiles[t].x)] = static_cast<int>(t);
  }
  return lookup;
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
  cl::Kernel kernel =
      context_.kernel(fmt::format("{}.cl", name), name, gridDefines(band.shape, space_, band.weight_scale));
  const cl::Buffer* buffers[] = {&band.tiles.positions(), &band.tiles.texelWeights(), &band.differences, &textures,
                                 &partial_.buffer()};
  cl_uint argument = 0;
  for (const cl::Buffer* buffer : buffers) kernel.setArg(argument++, *buffer);
  kernel.setArg(argument++, static_cast<cl_int>(band.first_row));
  kernel.setArg(argument++, static_cast<cl_int>(space_.columns));
  kernel.setArg(argument++, static_cast<cl_int>(space_.rows));
  const std::size_t cells = cellsOf16(band.weight_scale);
  if (gpu_) {
    context_.run(kernel, cl::NDRange(space_.systemEntries(), cells * cells, tiles),
                 cl::NDRange(context_.workGroupSize(kernel, kTileSide), 1, 1));
  } else {
    context_.run(kernel, cl::NDRange(1, tiles), cl::NDRange(1, 1));
  }
}

void WeightSystem::gather(const GridBand& band, const cl::Buffer& tile_at, const WeightWindow& window,
                          double metric_weight) {
  const std::size_t entries = space_.systemEntries();
  const WindowRows& rows = window.rows();
  system_.reserve(static_cast<std::size_t>(rows.count() * space_.columns) * entries * sizeof(float));
  cl::Kernel kernel = context_.kernel("weight_system_gather.cl", "weight_system_gather",
                                      fmt::format("-D ENTRIES={} -D WEIGHT_SCALE={}", entries, band.weight_scale));
  kernel.setArg(0, tile_at);
  kernel.setArg(1, partial_.buffer());
  kernel.setArg(2, system_.buffer());
  kernel.setArg(3, static_cast<cl_int>(tilesAlong(band.shape.width)));
  kernel.setArg(4, static_cast<cl_int>(tilesAlong(band.shape.rows)));
  kernel.setArg(5, static_cast<cl_int>(band.first_row));
  kernel.setArg(6, static_cast<cl_int>(rows.begin));
  kernel.setArg(7, static_cast<cl_int>(space_.columns));
  kernel.setArg(8, static_cast<cl_int>(space_.rows));
  kernel.setArg(9, static_cast<cl_float>(metric_weight));
  kernel.setArg(10, static_cast<cl_int>(empty_ ? 0 : 1));
  context_.run(
      kernel,
      cl::NDRange(entries / 16, static_cast<std::size_t>(space_.columns), static_cast<std::size_t>(rows.count())),
      cl::NullRange);
  empty_ = false;
}

void WeightSystem::gather(const HalfCells& halves, const WeightWindow& window) {
  const WindowRows& rows = window.rows();
  system_.reserve(static_cast<std::size_t>(rows.count() * space_.columns) * space_.systemEntries() * sizeof(float));
  cl::Kernel kernel =
      context_.kernel("half_cell_gather.cl", "half_cell_gather",
                      fmt::format("-D TEXTURES={} -D EXPRESSION_LANES={}", space_.textures, space_.lanes()));
  kernel.setArg(0, halves.equations());
  kernel.setArg(1, system_.buffer());
  kernel.setArg(2, static_cast<cl_int>(halves.firstHalfRow()));
  kernel.setArg(3, static_cast<cl_int>(halves.halfRows()));
  kernel.setArg(4, static_cast<cl_int>(rows.begin));
  kernel.setArg(5, static_cast<cl_int>(space_.rows));
  kernel.setArg(6, static_cast<cl_int>(halves.halfColumns()));
  context_.run(kernel,
               cl::NDRange(1 + space_.cellFloats() / 16, static_cast<std::size_t>(space_.columns),
                           static_cast<std::size_t>(rows.count())),
               cl::NullRange);
  empty_ = false;
}

void WeightSystem::relax(const WeightWindow& window, int sweeps, float smoothness, float trust) {
  assert(smoothness > 0.0f && trust > 0.0f && !empty_);
  const WindowRows& rows = window.rows();
  const std::size_t lanes = gpu_ ? 1 : 16;
  cl::Kernel kernel = context_.kernel(
      "weight_relax.cl", "weight_relax",
      fmt::format("-D TEXTURES={} -D EXPRESSION_LANES={} -D LANES={}", space_.textures, space_.lanes(), lanes));
  kernel.setArg(0, system_.buffer());
  kernel.setArg(1, window.startBuffer());
  kernel.setArg(2, window.weightsBuffer());
  kernel.setArg(5, static_cast<cl_int>(space_.columns));
  kernel.setArg(6, static_cast<cl_int>(rows.count()));
  kernel.setArg(7, smoothness);
  kernel.setArg(8, trust);
  const std::size_t items = space_.lanes() / lanes;
  for (int step = 0; step < 4 * sweeps; ++step) {
    const int column = step % 2;
    // Colours by the parity of the grid's rows, so that a window's place does not change them.
    const int row = rows.free_begin + (rows.free_begin + step / 2) % 2;
    if (row >= rows.free_end || column >= space_.columns) continue;
    kernel.setArg(3, static_cast<cl_int>(column));
    kernel.setArg(4, static_cast<cl_int>(row - rows.begin));
    context_.run(kernel,
                 cl::NDRange(items, static_cast<std::size_t>((space_.columns - column + 1) / 2),
                             static_cast<std::size_t>((rows.free_end - row + 1) / 2)),
                 cl::NullRange);
  }
}

}  // namespace facezip::compress
