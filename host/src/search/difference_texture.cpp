#include "search/difference_texture.hpp"

#include <fmt/format.h>

#include <cassert>

#include "bands/difference.hpp"
#include "io/counts.hpp"

namespace facezip::compress {
namespace {

/// The table as the kernel reads it: K x N x C, with N rounded up to 2 by zeros (two expressions at a time).
std::vector<float> kernelCoefficients(const TextureCoefficients& table) {
  const auto textures = toSize(table.textures);
  const auto expressions = toSize(table.expressions);
  const auto masks = toSize(table.masks);
  const std::size_t padded = roundUp(expressions, 2);
  assert(table.values.size() == masks * textures * expressions);
  std::vector<float> result(masks * padded * textures, 0.0f);
  for (std::size_t k = 0; k < masks; ++k) {
    for (std::size_t i = 0; i < textures; ++i) {
      for (std::size_t n = 0; n < expressions; ++n) {
        result[(k * padded + n) * textures + i] = table.values[(k * textures + i) * expressions + n];
      }
    }
  }
  return result;
}

}  // namespace

DifferenceTextures::DifferenceTextures(device::DeviceContext& context, const TextureCoefficients& coefficients,
                                       device::KernelVariant variant)
    : context_(context),
      variant_(context.resolve(variant)),
      textures_count_(coefficients.textures),
      expressions_(coefficients.expressions),
      coefficients_(context.upload(kernelCoefficients(coefficients), "coefficients of the difference textures")),
      textures_(context, "difference textures") {
  assert(textures_count_ >= 1 && textures_count_ <= 8 && expressions_ >= 1);
}

std::size_t DifferenceTextures::textureBytes(const DeviceTiles& tiles, const BandShape& shape) const {
  return tiles.tileCount() * toSize(textures_count_, shape.channels) * kTileTexels * sizeof(float);
}

const cl::Buffer& DifferenceTextures::compute(const DeviceTiles& tiles, const cl::Buffer& differences,
                                              const BandShape& shape) {
  assert(shape.expressions == expressions_);
  device::requireBytes(context_, differences, differenceBufferBytes(shape, tiles.tileCount()), "differences of a band");
  textures_.reserve(textureBytes(tiles, shape));
  if (tiles.tileCount() == 0) return textures_.buffer();
  // Sixteen texels fill the registers of a CPU; four keep to those that a GPU gives a work-item.
  const std::size_t width = variant_ == device::KernelVariant::kGpu ? 4 : 16;
  const cl::Kernel kernel =
      context_.kernel("difference_texture.cl", "difference_texture",
                      fmt::format("{} -D TEXTURES={} -D WIDTH={}", differenceDefines(shape), textures_count_, width));
  const std::size_t items = kTileTexels / width;
  context_.launch(
      kernel, device::WorkItems(items, tiles.tileCount()).inGroupsOf(context_.workGroupSize(kernel, items), 1),
      tiles.maskBegin(), tiles.maskIndex(), tiles.maskWeights(), coefficients_, differences, textures_, expressions_);
  return textures_.buffer();
}

}  // namespace facezip::compress
