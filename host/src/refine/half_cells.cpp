#include "refine/half_cells.hpp"

#include <algorithm>
#include <cassert>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

int groupsOf(const WeightSpace& space) { return divideUp(2 * space.columns, FACEZIP_VECTOR); }

}  // namespace

HalfCells::HalfCells(device::DeviceContext& context, const WeightSpace& space)
    : context_(context),
      space_(space),
      grams_(context, "Gram matrices of the half cells"),
      halves_(context, "equations of the half cells"),
      errors_(context, "errors of the half cells") {}

bool HalfCells::canHold(int weight_scale) {
  return weight_scale == 4 || weight_scale == 8 || weight_scale == 16 || weight_scale == 32;
}

std::size_t HalfCells::bytesOfCellRow(const WeightSpace& space) {
  const HalfCellRows rows{.first = 0, .count = 2, .groups = groupsOf(space)};
  return halfCellGramBytes(rows, space.expressions) +
         toSize(rows.count, rows.columns()) * halfCellEntries(space) * sizeof(float);
}

void HalfCells::moveTo(const WindowRows& rows) {
  window_rows_ = rows;
  const int first = std::max(0, 2 * rows.free_begin - 1);
  rows_ = {
      .first = first, .count = std::min(2 * space_.rows, 2 * rows.free_end + 1) - first, .groups = groupsOf(space_)};
  assert(rows_.first / 2 >= rows.begin && divideUp(rows_.first + rows_.count, 2) <= rows.end);
  grams_.reserve(halfCellGramBytes(rows_, space_.expressions));
  halves_.reserve(toSize(rows_.count, rows_.columns()) * halfCellEntries(space_) * sizeof(float));
  errors_.reserve(toSize(rows_.count, rows_.groups) * sizeof(float));
  empty_ = true;
}

void HalfCells::add(const GridBand& band, const cl::Buffer& tile_at, double metric_weight) {
  assert(canHold(band.weight_scale) && band.shape.expressions == space_.expressions);
  launchHalfCellGram(context_, {.band = band,
                                .rows = rows_,
                                .metric_weight = static_cast<float>(metric_weight),
                                .keep = !empty_,
                                .tile_at = tile_at,
                                .grams = grams_.buffer()});
  empty_ = false;
}

void HalfCells::fit(const WeightWindow& window, float ridge) {
  assert(!empty_);
  launchHalfCellFit(context_, {.window = window,
                               .rows = rows_,
                               .ridge = ridge,
                               .grams = grams_.buffer(),
                               .halves = halves_.buffer(),
                               .errors = errors_.buffer()});
}

double HalfCells::error() {
  const Layout places(rows_.count, rows_.groups);
  const device::MappedBytes mapped = errors_.mapForReading(places.size() * sizeof(float));
  const std::span<const float> errors = mapped.as<const float>();
  double sum = 0.0;
  for (int row = 2 * window_rows_.free_begin; row < 2 * window_rows_.free_end; ++row) {
    for (int group = 0; group < rows_.groups; ++group) {
      sum += static_cast<double>(errors[places(row - rows_.first, group)]);
    }
  }
  return sum;
}

}  // namespace facezip::compress
