#include "compress/texture_range.hpp"

#include <algorithm>
#include <limits>

namespace facezip::compress {

std::vector<TextureRange> TextureRangeFinder::find(const DeviceTiles& tiles, const BandShape& shape,
                                                   const cl::Buffer& textures, std::size_t first, std::size_t end) {
  const std::size_t planes = static_cast<std::size_t>(textures_count_) * static_cast<std::size_t>(shape.channels);
  std::vector<TextureRange> result(planes,
                                   {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()});
  if (tiles.tileCount() == 0) return result;
  device::requireBytes(context_, textures, tiles.tileCount() * planes * kTileTexels * sizeof(float),
                       "difference textures of a band");
  const std::size_t bytes = tiles.tileCount() * planes * sizeof(cl_float2);
  ranges_.reserve(bytes);
  cl::Kernel kernel = context_.kernel("difference_texture_range.cl", "difference_texture_range");
  kernel.setArg(0, tiles.maskBegin());
  kernel.setArg(1, tiles.maskWeights());
  kernel.setArg(2, textures);
  kernel.setArg(3, ranges_.buffer());
  kernel.setArg(4, static_cast<cl_int>(planes));
  context_.run(kernel, cl::NDRange(tiles.tileCount()), cl::NDRange(1));
  const device::MappedBytes mapped = ranges_.mapForReading(bytes);
  const std::span<const cl_float2> ranges = mapped.as<const cl_float2>();
  for (std::size_t i = first * planes; i < end * planes; ++i) {
    TextureRange& range = result[i % planes];
    range.min = std::min(range.min, ranges[i].s[0]);
    range.max = std::max(range.max, ranges[i].s[1]);
  }
  return result;
}

void widen(std::vector<TextureRange>& whole, std::span<const TextureRange> part) {
  if (whole.empty()) whole.assign(part.begin(), part.end());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    whole[i].min = std::min(whole[i].min, part[i].min);
    whole[i].max = std::max(whole[i].max, part[i].max);
  }
}

}  // namespace facezip::compress
