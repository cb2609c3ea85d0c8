#include "compress/difference_texture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>

#include "compress/difference.hpp"

namespace facezip::compress {
namespace {

/// The table as the kernel reads it: K x N x C, with N rounded up to 2 by zeros (two expressions at a time).
std::vector<float> kernelCoefficients(const TextureCoefficients& table) {
  const auto textures = static_cast<std::size_t>(table.textures);
  const auto expressions = static_cast<std::size_t>(table.expressions);
  const auto masks = static_cast<std::size_t>(table.masks);
  const std::size_t padded = device::roundUp(expressions, 2);
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

std::string encodeDefines(const BandShape& shape, int bits) {
  return fmt::format("-D CHANNELS={} -D CODE_BITS={}", shape.channels, bits);
}

}  // namespace

DifferenceTextures::DifferenceTextures(device::DeviceContext& context, const TextureCoefficients& coefficients,
                                       device::KernelVariant variant)
    : context_(context),
      variant_(context.resolve(variant)),
      textures_count_(coefficients.textures),
      expressions_(coefficients.expressions),
      coefficients_(context.upload(kernelCoefficients(coefficients), "coefficients of the difference textures")),
      textures_(context, "difference textures"),
      ranges_(context, "ranges of the difference textures"),
      encoding_(context, "encoding of the difference textures", CL_MEM_READ_ONLY),
      codes_(context, "codes of the difference textures") {
  assert(textures_count_ >= 1 && textures_count_ <= 8 && expressions_ >= 1);
}

std::size_t DifferenceTextures::textureBytes(const DeviceTiles& tiles, const BandShape& shape) const {
  return tiles.tileCount() * static_cast<std::size_t>(textures_count_) * static_cast<std::size_t>(shape.channels) *
         kTileTexels * sizeof(float);
}

const cl::Buffer& DifferenceTextures::compute(const DeviceTiles& tiles, const cl::Buffer& differences,
                                              const BandShape& shape) {
  assert(shape.expressions == expressions_);
  device::requireBytes(context_, differences, differenceBufferBytes(shape, tiles.tileCount()), "differences of a band");
  textures_.reserve(textureBytes(tiles, shape));
  if (tiles.tileCount() == 0) return textures_.buffer();
  // Sixteen texels fill the registers of a CPU; four keep to those that a GPU gives a work-item.
  const std::size_t width = variant_ == device::KernelVariant::kGpu ? 4 : 16;
  cl::Kernel kernel =
      context_.kernel("difference_texture.cl", "difference_texture",
                      fmt::format("{} -D TEXTURES={} -D WIDTH={}", differenceDefines(shape), textures_count_, width));
  kernel.setArg(0, tiles.maskBegin());
  kernel.setArg(1, tiles.maskIndex());
  kernel.setArg(2, tiles.maskWeights());
  kernel.setArg(3, coefficients_);
  kernel.setArg(4, differences);
  kernel.setArg(5, textures_.buffer());
  kernel.setArg(6, static_cast<cl_int>(expressions_));
  const std::size_t items = kTileTexels / width;
  context_.run(kernel, cl::NDRange(items, tiles.tileCount()), cl::NDRange(context_.workGroupSize(kernel, items), 1));
  return textures_.buffer();
}

std::vector<TextureRange> DifferenceTextures::range(const DeviceTiles& tiles, const BandShape& shape) {
  const std::size_t planes = static_cast<std::size_t>(textures_count_) * static_cast<std::size_t>(shape.channels);
  std::vector<TextureRange> result(planes,
                                   {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()});
  if (tiles.tileCount() == 0) return result;
  device::requireBytes(context_, textures_.buffer(), textureBytes(tiles, shape), "difference textures of a band");
  const std::size_t bytes = tiles.tileCount() * planes * sizeof(cl_float2);
  ranges_.reserve(bytes);
  cl::Kernel kernel = context_.kernel("difference_texture_range.cl", "difference_texture_range");
  kernel.setArg(0, tiles.maskBegin());
  kernel.setArg(1, tiles.maskWeights());
  kernel.setArg(2, textures_.buffer());
  kernel.setArg(3, ranges_.buffer());
  kernel.setArg(4, static_cast<cl_int>(planes));
  context_.run(kernel, cl::NDRange(tiles.tileCount()), cl::NDRange(1));
  const device::MappedBytes mapped = ranges_.mapForReading(bytes);
  const std::span<const cl_float2> ranges = mapped.as<const cl_float2>();
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    TextureRange& range = result[i % planes];
    range.min = std::min(range.min, ranges[i].s[0]);
    range.max = std::max(range.max, ranges[i].s[1]);
  }
  return result;
}

void DifferenceTextures::clear(const BandShape& shape, int bits) {
  cl::Kernel kernel =
      context_.kernel("difference_texture_encode.cl", "difference_texture_clear", encodeDefines(shape, bits));
  kernel.setArg(0, encoding_.buffer());
  kernel.setArg(1, codes_.buffer());
  context_.run(kernel,
               cl::NDRange(static_cast<std::size_t>(shape.width), static_cast<std::size_t>(shape.rows),
                           static_cast<std::size_t>(textures_count_)),
               cl::NullRange);
}

void DifferenceTextures::encode(const DeviceTiles& tiles, const BandShape& shape,
                                std::span<const TextureEncoding> encoding, int bits, std::span<std::byte> codes) {
  assert(encoding.size() == static_cast<std::size_t>(textures_count_) * static_cast<std::size_t>(shape.channels));
  assert(bits == 8 || bits == 16);
  assert(codes.size() == static_cast<std::size_t>(shape.rows) * static_cast<std::size_t>(shape.width) *
                             encoding.size() * static_cast<std::size_t>(bits / 8));
  std::vector<cl_float2> factors;
  for (const TextureEncoding& e : encoding) factors.push_back({{e.scale > 0.0f ? 1.0f / e.scale : 0.0f, e.offset}});
  encoding_.upload(std::span<const cl_float2>(factors));
  codes_.reserve(codes.size());
  clear(shape, bits);
  if (tiles.tileCount() > 0) {
    device::requireBytes(context_, textures_.buffer(), textureBytes(tiles, shape), "difference textures of a band");
    cl::Kernel kernel =
        context_.kernel("difference_texture_encode.cl", "difference_texture_encode", encodeDefines(shape, bits));
    kernel.setArg(0, tiles.positions());
    kernel.setArg(1, textures_.buffer());
    kernel.setArg(2, encoding_.buffer());
    kernel.setArg(3, codes_.buffer());
    kernel.setArg(4, static_cast<cl_int>(shape.width));
    kernel.setArg(5, static_cast<cl_int>(shape.rows));
    context_.run(kernel, cl::NDRange(kTileSide, static_cast<std::size_t>(textures_count_), tiles.tileCount()),
                 cl::NDRange(context_.workGroupSize(kernel, kTileSide), 1, 1));
  }
  const device::MappedBytes mapped = codes_.mapForReading(codes.size());
  if (!codes.empty()) std::memcpy(codes.data(), mapped.bytes().data(), codes.size());
}

}  // namespace facezip::compress
