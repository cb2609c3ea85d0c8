// window_pass.hpp - windows of rows of cells, from the top of the grid to its bottom: what is above stays as it is
// done, what is below still stands where it started.
#pragma once

#include <functional>
#include <vector>

#include "refine/grid_weights.hpp"
#include "refine/weight_window.hpp"

namespace facezip::compress {

using WindowStep = std::function<void(int begin, int end)>;

/// For rows [begin, end) of cells, `window_rows` at a time: prepare, which reads texels in another thread beside the
/// work on the window before; load, which puts them on the device; work. Throws what they throw.
void forEachWindow(int rows, int window_rows, const WindowStep& prepare, const WindowStep& load,
                   const WindowStep& work);

/// Moves a window: rows above the free ones get the weights of `done`, the others those of `start`.
void moveWindow(WeightWindow& window, const WindowRows& rows, const EncodedWeights& start, const GridWeights& done);

/// Weights of a window's free rows, [row][column][C][lanes]. Waits.
std::vector<float> freeWeights(const WeightWindow& window);

}  // namespace facezip::compress
