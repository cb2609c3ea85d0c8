// weight_system_gather.hpp - problem of the step `weight_system_gather`: equations of the cells from sums of the tiles.
#pragma once

#include "problems/weight_system.hpp"
#include "reference/weight_system_gather.hpp"

namespace facezip::test {

/// Must move: the sums of the tiles once in, the equations once out.
struct WeightSystemGatherProblem : WeightSystemProblem {
  WeightSystemGatherProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free)
      : WeightSystemProblem(device, grid_sizes, std::move(tile_masks), free) {
    WeightSystemProblem::run();
  }

  void run() {
    system.clear();
    system.gather(band(), tile_at, window, 1.0);
    context.finish();
  }

  /// [held row][column][entry]
  Layout<3> systemLayout() const { return Layout(window.rows().count(), space.columns, space.systemEntries()); }
  std::vector<float> result() const {
    return context.download<float>(system.equations(), systemLayout().size(), "equations of the cells");
  }
  /// The tiles as they are on the device.
  std::vector<reference::TileSums> tileSums() const {
    const std::vector<float> sums = WeightSystemProblem::result();
    std::vector<reference::TileSums> all;
    for (std::size_t tile = 0; tile < tileCount(); ++tile) {
      const auto first = sums.begin() + static_cast<std::ptrdiff_t>(sumLayout()(tile, 0, 0, 0));
      const auto count = static_cast<std::ptrdiff_t>(sumLayout().size() / tileCount());
      all.push_back({patchRow(tile), patchColumn(tile), patchSide(), {first, first + count}});
    }
    return all;
  }

  double bytes() const { return sumBytes() + systemBytes(); }
  double flops() const { return 0.0; }
};

}  // namespace facezip::test
