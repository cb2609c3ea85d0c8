#include "refine/window_pass.hpp"

#include <algorithm>
#include <future>

#include "io/counts.hpp"

namespace facezip::compress {

void forEachWindow(int rows, int window_rows, const WindowStep& prepare, const WindowStep& load,
                   const WindowStep& work) {
  const auto endOf = [&](int begin) { return std::min(begin + window_rows, rows); };
  prepare(0, endOf(0));
  std::future<void> ahead;  // reads the window after the one at work
  for (int begin = 0; begin < rows; begin = endOf(begin)) {
    const int end = endOf(begin);
    if (ahead.valid()) ahead.get();
    load(begin, end);
    if (end < rows) ahead = std::async(std::launch::async, [&, end] { prepare(end, endOf(end)); });
    work(begin, end);
  }
}

void moveWindow(WeightWindow& window, const WindowRows& rows, const EncodedWeights& start, const GridWeights& done) {
  const WeightSpace& space = window.space();
  std::vector<float> from(toSize(rows.count()) * space.rowFloats());
  decodeRows(start, space, rows.begin, rows.end, from);
  std::vector<float> weights = from;
  const int above = rows.free_begin - rows.begin;
  done.load(rows.begin, rows.free_begin, std::span(weights).first(toSize(above) * space.rowFloats()));
  window.set(rows, weights, from);
}

std::vector<float> freeWeights(const WeightWindow& window) {
  const WindowRows& rows = window.rows();
  const std::vector<float> weights = window.weights();
  const auto row_floats = static_cast<std::ptrdiff_t>(window.space().rowFloats());
  return {weights.begin() + (rows.free_begin - rows.begin) * row_floats,
          weights.begin() + (rows.free_end - rows.begin) * row_floats};
}

}  // namespace facezip::compress
