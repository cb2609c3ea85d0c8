#include "refine/weight_window.hpp"

#include <cassert>

namespace facezip::compress {

WeightWindow::WeightWindow(device::DeviceContext& context, const WeightSpace& space)
    : space_(space), weights_(context, "grid weights"), start_(context, "grid weights at the start") {
  assert(space.columns >= 1 && space.rows >= 1 && space.expressions >= 1);
  assert(space.textures >= 1 && space.textures <= 8);
}

void WeightWindow::set(const WindowRows& rows, std::span<const float> weights, std::span<const float> start) {
  assert(0 <= rows.begin && rows.begin <= rows.free_begin && rows.free_begin <= rows.free_end);
  assert(rows.free_end <= rows.end && rows.end <= space_.rows);
  assert(weights.size() == toSize(rows.count()) * space_.rowFloats());
  assert(start.size() == weights.size());
  rows_ = rows;
  weights_.upload(weights);
  start_.upload(start);
}

std::vector<float> WeightWindow::weights() const {
  std::vector<float> values(toSize(rows_.count()) * space_.rowFloats());
  weights_.read(values);
  return values;
}

}  // namespace facezip::compress
