// weight_relax.hpp - problem of the step `weight_relax`.
#pragma once

#include "problems/weight_system.hpp"
#include "reference/weight_relax.hpp"

namespace facezip::test {

/// Must move, each sweep: the equations, where weights started and the weights in, the weights out. Operations: for
/// each expression of a cell a product with the blocks to eight neighbours and two triangles; smoothness and the factor
/// are left out.
struct WeightRelaxProblem : WeightSystemProblem {
  WeightRelaxProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free,
                     device::KernelVariant variant = device::KernelVariant::kAuto)
      : WeightSystemProblem(device, grid_sizes, std::move(tile_masks), free, variant) {
    system.add(band(), tile_at, fit.textures(), window, 1.0);
    context.finish();
  }

  void run() {
    system.relax(window, sweeps, smoothness, trust);
    context.finish();
  }
  /// The whole grid after the sweeps, from where it started.
  reference::GridWeights expected() const {
    const std::vector<reference::FitTexel> texels = fitTexels(DifferenceFitProblem::result());
    reference::GridWeights grid = weights;
    const compress::WindowRows& rows = window.rows();
    for (int step = 0; step < 4 * sweeps; ++step) {
      for (int row = rows.free_begin; row < rows.free_end; ++row) {
        if (row % 2 != step / 2 % 2) continue;
        for (int column = step % 2; column < space.columns; column += 2) {
          reference::relaxCell(grid, weights, texels, row, column, static_cast<double>(smoothness),
                               static_cast<double>(trust));
        }
      }
    }
    return grid;
  }

  double bytes() const { return sweeps * (systemBytes() + 3.0 * weightBytes()); }
  double flops() const { return sweeps * 2.0 * cells() * space.expressions * 9.0 * space.textures * space.textures; }

  int sweeps = 2;
  float smoothness = 40.0f;
  float trust = 15.0f;
};

}  // namespace facezip::test
