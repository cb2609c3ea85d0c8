// compress_stretch.hpp - problem of the step `compress_stretch`: Eq. 13 of Li et al. 2020 on a band.
#pragma once

#include "compress/compress_stretch.hpp"
#include "problems/grid.hpp"
#include "reference/compress_stretch.hpp"

namespace facezip::test {

/// Must move: differences in, two textures out. Operations: a bilinear weight for each expression and map, a product
/// for each of its channels.
struct CompressStretchProblem : GridProblem {
  CompressStretchProblem(device::DeviceContext& device, GridSizes grid_sizes, TileMasks tile_masks,
                         device::KernelVariant variant = device::KernelVariant::kAuto)
      : GridProblem(device, twoTextures(grid_sizes), std::move(tile_masks), Free::kAllRows),
        gpu(device.resolve(variant) == device::KernelVariant::kGpu),
        textures(device, textureLayout().size() * sizeof(float)) {}

  void run() {
    compress::launchCompressStretch(context, band(), window, gpu, textures.buffer());
    context.finish();
  }
  std::vector<float> result() const { return textures.read<float>(); }
  double expected(std::size_t tile, int plane, int t) const {
    double sum = 0.0;
    for (int n = 0; n < shape.expressions && wanted(tile, t); ++n) {
      const double share =
          reference::bilinear(x(tile, t), y(tile, t), sizes.weight_scale, space.columns, space.rows,
                              [&](int row, int column) { return weights.at(row, column, plane / shape.channels, n); });
      sum += share * delta()[deltaLayout()(tile, n, plane % shape.channels, t)];
    }
    return sum;
  }

  double bytes() const { return differenceBytes() + textureBytes(); }
  double flops() const { return texels() * shape.expressions * space.textures * (9.0 + 2.0 * shape.channels); }

  bool gpu;
  GuardedBuffer textures;

 private:
  static GridSizes twoTextures(GridSizes sizes) {
    sizes.textures = compress::kCompressStretchMaps;
    return sizes;
  }
};

}  // namespace facezip::test
