#include "refine/difference_fit.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "bands/difference.hpp"
#include "io/counts.hpp"

namespace facezip::compress {

int differenceFactorPlanes(const WeightSpace& space, int channels) {
  return FACEZIP_FACTOR_PLANES(space.textures, channels);
}

DifferenceFit::DifferenceFit(device::DeviceContext& context, const WeightSpace& space, device::KernelVariant variant)
    : context_(context),
      space_(space),
      gpu_(context.resolve(variant) == device::KernelVariant::kGpu),
      textures_(context, "difference textures"),
      factors_(context, "factors of the difference textures"),
      errors_(context, "errors of the difference textures"),
      encoding_(context, "encoding of the difference textures", CL_MEM_READ_ONLY) {}

const cl::Buffer& DifferenceFit::compute(const GridBand& band, const WeightWindow& window, float ridge) {
  return run(band, window, ridge, "");
}

const cl::Buffer& DifferenceFit::computeRounded(const GridBand& band, const WeightWindow& window, float ridge,
                                                std::span<const TextureEncoding> encoding, int bits) {
  assert(encoding.size() == toSize(space_.textures * band.shape.channels));
  std::vector<cl_float2> codes;
  for (const TextureEncoding& e : encoding) {
    codes.push_back({{e.scale, e.scale > 0.0f ? std::round(-e.offset / e.scale) : 0.0f}});
  }
  encoding_.upload(codes);
  return run(band, window, ridge, fmt::format(" -D CODES={}", (1 << bits) - 1));
}

const cl::Buffer& DifferenceFit::computeFactors(const GridBand& band, const WeightWindow& window, float ridge) {
  return run(band, window, ridge, " -D FACTORS");
}

const cl::Buffer& DifferenceFit::run(const GridBand& band, const WeightWindow& window, float ridge,
                                     const std::string& form) {
  assert(band.shape.expressions == space_.expressions && ridge > 0.0f);
  tile_count_ = band.tiles.tileCount();
  const std::size_t items = gpu_ ? kTileTexels : 1;  // of a tile
  const bool factors = form.find("FACTORS") != std::string::npos;
  const int planes =
      factors ? differenceFactorPlanes(space_, band.shape.channels) : space_.textures * band.shape.channels;
  device::PooledBuffer& output = factors ? factors_ : textures_;
  output.reserve(toSize(tile_count_, planes, kTileTexels) * sizeof(float));
  errors_.reserve(tile_count_ * items * sizeof(cl_float2));
  encoding_.reserve(sizeof(cl_float2));  // a kernel that doesn't round is given a buffer all the same
  if (tile_count_ == 0) return output.buffer();
  device::requireBytes(context_, band.differences, differenceBufferBytes(band.shape, tile_count_),
                       "differences of a band");
  const std::string defines =
      fmt::format("{} -D LANES={} -D ROWS={}{}", gridDefines(band.shape, space_, band.weight_scale),
                  gpu_ ? 1 : kTileSide, gpu_ ? 1 : kTileSide, form);
  const cl::Kernel kernel = context_.kernel("difference_fit.cl", "difference_fit", defines);
  context_.launch(kernel, device::WorkItems(items, tile_count_).inGroupsOf(context_.workGroupSize(kernel, items), 1),
                  band.tiles.positions(), band.tiles.texelWeights(), band.tiles.maskWeights(), band.differences,
                  window.weightsBuffer(), encoding_, output, errors_, band.first_row, window.rows().begin,
                  space_.columns, space_.rows, ridge);
  return output.buffer();
}

std::vector<FitError> DifferenceFit::errors() { return addTileErrors(errors_, tile_count_, gpu_ ? kTileTexels : 1); }

std::vector<FitError> addTileErrors(device::PooledBuffer& sums, std::size_t tiles, std::size_t sums_of_tile) {
  std::vector<FitError> result(tiles);
  if (tiles == 0) return result;
  const device::MappedBytes mapped = sums.mapForReading(tiles * sums_of_tile * sizeof(cl_float2));
  const std::span<const cl_float2> parts = mapped.as<const cl_float2>();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    result[i / sums_of_tile].weighted += static_cast<double>(parts[i].s[0]);
    result[i / sums_of_tile].plain += static_cast<double>(parts[i].s[1]);
  }
  return result;
}

}  // namespace facezip::compress
