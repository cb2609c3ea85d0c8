// difference_fit.hpp - problem of the step `difference_fit`.
#pragma once

#include "problems/grid.hpp"
#include "reference/difference_fit.hpp"
#include "reference/weight_system.hpp"
#include "refine/difference_fit.hpp"

namespace facezip::test {

/// Must move: differences, texel weights and the mask that marks what is wanted, grid weights in; textures out.
/// Operations: a weight between two rows of cells, the sums of the C x C system, its right-hand sides and the energy,
/// for each expression; the solution, about a tenth more at N = 20, is left out.
struct DifferenceFitProblem : GridProblem {
  DifferenceFitProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free,
                       device::KernelVariant variant = device::KernelVariant::kAuto)
      : GridProblem(device, grid_sizes, std::move(tile_masks), free), fit(device, space, variant) {}

  void run() {
    fit.compute(band(), window, ridge);
    context.finish();
  }
  /// Rounded to 8 bits.
  void runRounded() {
    fit.computeRounded(band(), window, ridge, encoding(), 8);
    context.finish();
  }
  std::vector<compress::TextureEncoding> encoding() const {
    return std::vector<compress::TextureEncoding>(toSize(planes()), compress::encodingFor({-300.0f, 200.0f}, 8));
  }
  std::vector<float> result() const {
    return context.download<float>(fit.textures(), textureLayout().size(), "difference textures");
  }
  /// D of a texel, C x channels.
  Eigen::MatrixXd expected(std::size_t tile, int t) const {
    return reference::fitDifference(weightsOf(tile, t), deltaOf(tile, t), static_cast<double>(ridge));
  }

  /// The texels of the band with these textures.
  std::vector<reference::FitTexel> fitTexels(const std::vector<float>& textures) const {
    std::vector<reference::FitTexel> texels;
    for (std::size_t tile = 0; tile < tileCount(); ++tile) appendTexels(textures, tile, texels);
    return texels;
  }
  void appendTexels(const std::vector<float>& textures, std::size_t tile,
                    std::vector<reference::FitTexel>& texels) const {
    for (int t = 0; t < kTileTexels; ++t) {
      if (texelWeight(tile, t) == 0.0) continue;
      texels.push_back({x(tile, t), y(tile, t), texelWeight(tile, t), textureOf(textures, tile, t), deltaOf(tile, t)});
    }
  }

  double bytes() const { return differenceBytes() + 2.0 * texelWeightBytes() + weightBytes() + textureBytes(); }
  double flops() const {
    const double c = space.textures;
    const double channels = shape.channels;
    return 2.0 * texels() * space.expressions * (c + pairs() + c * channels + channels);
  }

  float ridge = 0.01f;
  compress::DifferenceFit fit;
};

}  // namespace facezip::test
