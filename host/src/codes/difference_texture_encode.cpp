#include "codes/difference_texture_encode.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cstring>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

std::string encodeDefines(const BandShape& shape, int bits) {
  return fmt::format("-D CHANNELS={} -D CODE_BITS={}", shape.channels, bits);
}

}  // namespace

void TextureEncoder::clear(const BandShape& shape, int bits) {
  const cl::Kernel kernel =
      context_.kernel("difference_texture_encode.cl", "difference_texture_clear", encodeDefines(shape, bits));
  const std::size_t local = context_.workGroupSize(kernel, kTileSide);
  const cl_ulong texels = toSize(shape.rows, shape.width);
  const std::size_t items = roundUp(divideUp(texels, FACEZIP_CLEARED_TEXELS), local);
  context_.launch(kernel, device::WorkItems(items, textures_count_).inGroupsOf(local, 1), encoding_, codes_, texels);
}

void TextureEncoder::encode(const DeviceTiles& tiles, const BandShape& shape, const cl::Buffer& textures,
                            std::span<const TextureEncoding> encoding, int bits, std::span<std::byte> codes) {
  assert(encoding.size() == toSize(textures_count_, shape.channels));
  assert(bits == 8 || bits == 16);
  assert(codes.size() == toSize(shape.rows, shape.width) * encoding.size() * toSize(bits / 8));
  std::vector<cl_float2> factors;
  for (const TextureEncoding& e : encoding) factors.push_back({{e.scale > 0.0f ? 1.0f / e.scale : 0.0f, e.offset}});
  encoding_.upload(factors);
  codes_.reserve(codes.size());
  clear(shape, bits);
  if (tiles.tileCount() > 0) {
    device::requireBytes(context_, textures, tiles.tileCount() * encoding.size() * kTileTexels * sizeof(float),
                         "difference textures of a band");
    const cl::Kernel kernel =
        context_.kernel("difference_texture_encode.cl", "difference_texture_encode", encodeDefines(shape, bits));
    context_.launch(kernel,
                    device::WorkItems(kTileSide, textures_count_, tiles.tileCount())
                        .inGroupsOf(context_.workGroupSize(kernel, kTileSide), 1, 1),
                    tiles.positions(), textures, encoding_, codes_, shape.width, shape.rows);
  }
  const device::MappedBytes mapped = codes_.mapForReading(codes.size());
  if (!codes.empty()) std::memcpy(codes.data(), mapped.bytes().data(), codes.size());
}

}  // namespace facezip::compress
