#include "compress/refine/half_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "compress/bands/difference.hpp"

namespace facezip::compress {
namespace {

constexpr int kLanes = 16;  ///< half cells of a work-item

std::size_t gramFloats(const WeightSpace& space) {
  const auto n = static_cast<std::size_t>(space.expressions);
  return n * (n + 1) / 2;
}

/// HALF_ENTRIES of kernels/cl/common.cl.
std::size_t entriesOf(const WeightSpace& space) {
  return device::roundUp(static_cast<std::size_t>(space.textures * (space.textures + 1) / 2), 16) + space.cellFloats();
}

int groupsOf(const WeightSpace& space) { return (2 * space.columns + kLanes - 1) / kLanes; }

}  // namespace

HalfCells::HalfCells(device::DeviceContext& context, const WeightSpace& space)
    : context_(context),
      space_(space),
      groups_(groupsOf(space)),
      grams_(context, "Gram matrices of the half cells"),
      halves_(context, "equations of the half cells"),
      errors_(context, "errors of the half cells") {}

bool HalfCells::canHold(int weight_scale) {
  return weight_scale == 4 || weight_scale == 8 || weight_scale == 16 || weight_scale == 32;
}

std::size_t HalfCells::bytesOfCellRow(const WeightSpace& space) {
  return 2 * static_cast<std::size_t>(groupsOf(space) * kLanes) * (gramFloats(space) + entriesOf(space)) *
         sizeof(float);
}

void HalfCells::moveTo(const WindowRows& rows) {
  rows_ = rows;
  first_half_row_ = std::max(0, 2 * rows.free_begin - 1);
  half_rows_ = std::min(2 * space_.rows, 2 * rows.free_end + 1) - first_half_row_;
  assert(first_half_row_ / 2 >= rows.begin && (first_half_row_ + half_rows_ + 1) / 2 <= rows.end);
  const auto items = static_cast<std::size_t>(half_rows_ * groups_);
  grams_.reserve(items * gramFloats(space_) * kLanes * sizeof(float));
  halves_.reserve(items * entriesOf(space_) * kLanes * sizeof(float));
  errors_.reserve(items * sizeof(float));
  empty_ = true;
}

void HalfCells::add(const GridBand& band, const cl::Buffer& tile_at, double metric_weight) {
  assert(canHold(band.weight_scale) && band.shape.expressions == space_.expressions);
  device::requireBytes(context_, band.differences, differenceBufferBytes(band.shape, band.tiles.tileCount()),
                       "differences of a band");
  cl::Kernel kernel = context_.kernel("half_cell_gram.cl", "half_cell_gram",
                                      fmt::format("{} -D EXPRESSIONS={} -D HALF={}", differenceDefines(band.shape),
                                                  space_.expressions, band.weight_scale / 2));
  const auto tilesAlong = [](int texels) { return static_cast<cl_int>((texels + kTileSide - 1) / kTileSide); };
  const cl::Buffer* buffers[] = {&tile_at, &band.tiles.texelWeights(), &band.differences, &grams_.buffer()};
  cl_uint argument = 0;
  for (const cl::Buffer* buffer : buffers) kernel.setArg(argument++, *buffer);
  kernel.setArg(argument++, tilesAlong(band.shape.width));
  kernel.setArg(argument++, tilesAlong(band.shape.rows));
  kernel.setArg(argument++, static_cast<cl_int>(band.first_row));
  kernel.setArg(argument++, static_cast<cl_int>(first_half_row_));
  kernel.setArg(argument++, static_cast<cl_float>(metric_weight));
  kernel.setArg(argument++, static_cast<cl_int>(empty_ ? 0 : 1));
  context_.run(kernel, cl::NDRange(static_cast<std::size_t>(groups_), static_cast<std::size_t>(half_rows_)),
               cl::NDRange(1, 1));
  empty_ = false;
}

void HalfCells::fit(const WeightWindow& window, float ridge) {
  assert(!empty_ && ridge > 0.0f);
  cl::Kernel kernel = context_.kernel("half_cell_fit.cl", "half_cell_fit",
                                      fmt::format("-D TEXTURES={} -D EXPRESSIONS={} -D EXPRESSION_LANES={}",
                                                  space_.textures, space_.expressions, space_.lanes()));
  const cl::Buffer* buffers[] = {&grams_.buffer(), &window.weightsBuffer(), &halves_.buffer(), &errors_.buffer()};
  cl_uint argument = 0;
  for (const cl::Buffer* buffer : buffers) kernel.setArg(argument++, *buffer);
  kernel.setArg(argument++, static_cast<cl_int>(first_half_row_));
  kernel.setArg(argument++, static_cast<cl_int>(window.rows().begin));
  kernel.setArg(argument++, static_cast<cl_int>(space_.columns));
  kernel.setArg(argument++, static_cast<cl_int>(space_.rows));
  kernel.setArg(argument++, ridge);
  context_.run(kernel, cl::NDRange(static_cast<std::size_t>(groups_), static_cast<std::size_t>(half_rows_)),
               cl::NDRange(1, 1));
}

double HalfCells::error() {
  const device::MappedBytes mapped =
      errors_.mapForReading(static_cast<std::size_t>(half_rows_ * groups_) * sizeof(float));
  const std::span<const float> errors = mapped.as<const float>();
  double sum = 0.0;
  for (int row = 2 * rows_.free_begin; row < 2 * rows_.free_end; ++row) {
    const auto first = static_cast<std::size_t>((row - first_half_row_) * groups_);
    for (int group = 0; group < groups_; ++group)
      sum += static_cast<double>(errors[first + static_cast<std::size_t>(group)]);
  }
  return sum;
}

}  // namespace facezip::compress
