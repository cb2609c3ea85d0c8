// difference_settle.hpp - problem of the step `difference_settle`.
#pragma once

#include "problems/difference_target.hpp"
#include "refine/difference_settle.hpp"

namespace facezip::test {

/// Must move: factors, codes and texel weights in, textures out.
struct DifferenceSettleProblem : DifferenceTargetProblem {
  DifferenceSettleProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free,
                          device::KernelVariant kernel_variant = device::KernelVariant::kAuto)
      : DifferenceTargetProblem(device, grid_sizes, std::move(tile_masks), free, kernel_variant),
        textures(device, textureLayout().size() * sizeof(float)),
        errors(device, tileCount() * toSize(errorsOfTile()) * sizeof(cl_float2)) {}

  int errorsOfTile() const { return compress::settledErrors(context, variant); }
  void run() {
    compress::launchDifferenceSettle(context, space, buffers(),
                                     {tiles.texelWeights(), textures.buffer(), errors.buffer()}, ridge, variant);
    context.finish();
  }
  std::vector<float> result() const { return textures.read<float>(); }
  /// Weighted and plain squared error of a tile.
  std::array<double, 2> errorOf(std::size_t tile) const {
    const std::vector<cl_float2> all = errors.read<cl_float2>();
    std::array<double, 2> sum = {0.0, 0.0};
    for (int i = 0; i < errorsOfTile(); ++i) {
      const cl_float2& one = all[tile * toSize(errorsOfTile()) + toSize(i)];
      for (std::size_t k = 0; k < 2; ++k) sum[k] += static_cast<double>(one.s[k]);
    }
    return sum;
  }

  double bytes() const { return factorBytes() + 2.0 * textureBytes() + texelWeightBytes(); }
  double flops() const { return texels() * shape.channels * (2.0 * pairs() + 4.0 * space.textures); }

  GuardedBuffer textures;
  GuardedBuffer errors;
};

}  // namespace facezip::test
