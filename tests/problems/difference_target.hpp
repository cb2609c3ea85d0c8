// difference_target.hpp - problem of the step `difference_target`.
#pragma once

#include "problems/difference_fit.hpp"
#include "reference/difference_target.hpp"
#include "refine/difference_target.hpp"

namespace facezip::test {

/// Codes from a hash stand for what blocks decode to. Must move: factors and the codes of the other textures in, those
/// of one out.
struct DifferenceTargetProblem : DifferenceFitProblem {
  DifferenceTargetProblem(device::DeviceContext& device, const GridSizes& grid_sizes, TileMasks tile_masks, Free free,
                          device::KernelVariant kernel_variant = device::KernelVariant::kAuto)
      : DifferenceFitProblem(device, grid_sizes, std::move(tile_masks), free, kernel_variant),
        variant(kernel_variant),
        codes(device, textureLayout().size() * sizeof(float)) {
    Hashed hashed(21);
    given.resize(textureLayout().size());
    for (float& code : given) code = hashed.between(-3.0f, 258.0f);
    device.write(codes.buffer(), given, "codes");
    std::vector<cl_float2> pairs_of_planes;
    for (int plane = 0; plane < planes(); ++plane) {
      // The last plane of many is a constant.
      const bool constant = planes() > 2 && plane + 1 == planes();
      scales.push_back(constant ? 0.0 : 0.25 + 0.125 * plane);
      zeros.push_back(120.0 + plane);
      pairs_of_planes.push_back({{static_cast<float>(scales.back()), static_cast<float>(zeros.back())}});
    }
    encoding_buffer = device.upload(pairs_of_planes, "encoding");
    factors = fit.computeFactors(band(), window, ridge);
  }

  compress::CodedBuffers buffers() const {
    return {tileCount(), shape.channels, factors, encoding_buffer, codes.buffer()};
  }
  void run(int texture) {
    compress::launchDifferenceTarget(context, space, buffers(), texture, variant);
    context.finish();
  }
  void run() { run(space.textures / 2); }
  std::vector<float> result() const { return codes.read<float>(); }

  /// D of all planes at a texel from codes, C x channels.
  Eigen::MatrixXd decoded(const std::vector<float>& values, std::size_t tile, int t) const {
    Eigen::MatrixXd d(space.textures, shape.channels);
    for (int plane = 0; plane < planes(); ++plane) {
      d(plane / shape.channels, plane % shape.channels) =
          scales[toSize(plane)] * (static_cast<double>(values[textureLayout()(tile, plane, t)]) - zeros[toSize(plane)]);
    }
    return d;
  }

  double factorBytes() const {
    return texels() * compress::differenceFactorPlanes(space, shape.channels) * sizeof(float);
  }
  double bytes() const { return (factorBytes() + textureBytes()) / 2.0; }  // half of the textures, as run() takes them
  double flops() const { return texels() * shape.channels * (3.0 * space.textures / 2.0 + 3.0); }

  device::KernelVariant variant;
  GuardedBuffer codes;
  std::vector<float> given;
  std::vector<double> scales, zeros;  ///< of every plane
  cl::Buffer encoding_buffer;
  cl::Buffer factors;
};

}  // namespace facezip::test
