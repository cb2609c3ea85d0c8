// weight_blend.hpp - problem of the step `weight_blend`.
#pragma once

#include <cmath>
#include <vector>

#include "blend/weight_blend.hpp"
#include "problems/hashed.hpp"
#include "reference/weight_blend.hpp"

namespace facezip::test {

struct WeightBlendSizes {
  int columns = 0;
  int rows = 0;
  int channels = 4;  ///< C
  int expressions = 0;
};

/// Codes from a hash, channel i with (1 + i) / 255 a code from -0.3 i on.
inline reference::WeightMaps hashedWeightMaps(const WeightBlendSizes& sizes) {
  reference::WeightMaps maps{sizes.columns, sizes.rows, sizes.channels, sizes.expressions, {}, {}, {}};
  maps.codes.resize(toSize(sizes.columns, sizes.rows, sizes.channels, sizes.expressions));
  Hashed(7).fill(std::as_writable_bytes(std::span(maps.codes)));
  for (int i = 0; i < sizes.channels; ++i) {
    maps.scale.push_back((1.0 + i) / 255.0);
    maps.offset.push_back(-0.3 * i);
  }
  return maps;
}

/// As the run time holds them.
inline blend::WeightMaps uploadWeightMaps(device::DeviceContext& device, const reference::WeightMaps& maps,
                                          device::KernelVariant variant) {
  const blend::WeightCodes grid{{maps.columns, maps.rows}, maps.expressions, maps.scale, maps.offset};
  std::vector<std::byte> codes(grid.codeBytes());
  std::size_t next = 0;
  for (int n = 0; n < maps.expressions; ++n) {
    for (std::size_t cell = 0; cell < grid.cellCount(); ++cell) {
      for (int i = 0; i < maps.channels; ++i) codes[grid.codeIndex(n, cell, i)] = std::byte{maps.codes[next++]};
    }
  }
  return blend::WeightMaps(device, grid, codes, variant);
}

/// With new weights as a frame has them; a third are 0. Must move: the codes of the others in, the weights out.
struct WeightBlendProblem {
  WeightBlendProblem(device::DeviceContext& device, const WeightBlendSizes& problem_sizes,
                     device::KernelVariant variant = device::KernelVariant::kAuto)
      : context(device),
        sizes(problem_sizes),
        maps(hashedWeightMaps(sizes)),
        on_device(uploadWeightMaps(device, maps, variant)) {
    for (int n = 0; n < sizes.expressions; ++n) {
      beta.push_back(n % 3 == 1 ? 0.0f : std::sin(1.0f + 2.0f * static_cast<float>(n)));
    }
  }

  void run() {
    on_device.blend(beta);
    context.finish();
  }
  /// [row][column][C]
  std::vector<float> result() const {
    const blend::WeightCodes& grid = on_device.grid();
    const Layout places(grid.blocks(), grid.channels(), blend::WeightCodes::kBlockCells);
    const std::vector<float> blocks = context.download<float>(on_device.weights(), places.size(), "blended weights");
    std::vector<float> weights;
    for (std::size_t cell = 0; cell < grid.cellCount(); ++cell) {
      const std::size_t block = cell / blend::WeightCodes::kBlockCells;
      for (int i = 0; i < grid.channels(); ++i) {
        weights.push_back(blocks[places(block, i, cell % blend::WeightCodes::kBlockCells)]);
      }
    }
    return weights;
  }
  /// gain  of every cell; empty for 1
  std::vector<double> expected(const std::vector<float>& gain = {}) const {
    return reference::blendWeights(maps, beta, gain);
  }

  double bytes() const {
    const auto active = static_cast<double>(std::ranges::count_if(beta, [](float b) { return b != 0.0f; }));
    const double outputs = static_cast<double>(on_device.grid().cellCount()) * sizes.channels;
    return outputs * (active + static_cast<double>(sizeof(float)));
  }

  device::DeviceContext& context;
  WeightBlendSizes sizes;
  reference::WeightMaps maps;
  blend::WeightMaps on_device;
  std::vector<float> beta;
};

}  // namespace facezip::test
