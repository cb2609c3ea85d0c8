#include "refine/difference_texture_range.hpp"

#include <algorithm>
#include <functional>
#include <limits>

#include "io/counts.hpp"

namespace facezip::compress {

std::vector<TextureRange> TextureRangeFinder::findPerTile(const DeviceTiles& tiles, const BandShape& shape,
                                                          const cl::Buffer& textures, std::size_t first,
                                                          std::size_t end) {
  const std::size_t planes = toSize(textures_count_, shape.channels);
  std::vector<TextureRange> result;
  if (first == end) return result;
  device::requireBytes(context_, textures, tiles.tileCount() * planes * kTileTexels * sizeof(float),
                       "difference textures of a band");
  const std::size_t bytes = tiles.tileCount() * planes * sizeof(cl_float2);
  ranges_.reserve(bytes);
  context_.launch(context_.kernel("difference_texture_range.cl", "difference_texture_range"),
                  device::WorkItems(tiles.tileCount()).inGroupsOf(1), tiles.maskBegin(), tiles.maskWeights(), textures,
                  ranges_, static_cast<cl_int>(planes));
  const device::MappedBytes mapped = ranges_.mapForReading(bytes);
  const std::span<const cl_float2> ranges = mapped.as<const cl_float2>();
  for (std::size_t i = first * planes; i < end * planes; ++i) result.push_back({ranges[i].s[0], ranges[i].s[1]});
  return result;
}

std::vector<TextureRange> TextureRangeFinder::find(const DeviceTiles& tiles, const BandShape& shape,
                                                   const cl::Buffer& textures, std::size_t first, std::size_t end) {
  const std::size_t planes = toSize(textures_count_, shape.channels);
  return clippedRange(findPerTile(tiles, shape, textures, first, end), planes, 0.0, 0.0);
}

std::vector<TextureRange> clippedRange(std::span<const TextureRange> tiles, std::size_t planes, double clipped,
                                       double most) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<TextureRange> result(planes, {kInfinity, -kInfinity});
  const std::size_t count = tiles.size() / planes;
  const auto beyond = static_cast<std::size_t>(clipped * static_cast<double>(count));
  if (count == 0) return result;
  std::vector<float> ends(count);
  for (std::size_t plane = 0; plane < planes; ++plane) {
    for (std::size_t t = 0; t < count; ++t) ends[t] = tiles[t * planes + plane].min;
    std::nth_element(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(beyond), ends.end());
    result[plane].min = std::min(ends[beyond], *std::ranges::min_element(ends) + static_cast<float>(most));
    for (std::size_t t = 0; t < count; ++t) ends[t] = tiles[t * planes + plane].max;
    std::nth_element(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(beyond), ends.end(), std::greater<>());
    result[plane].max = std::max(ends[beyond], *std::ranges::max_element(ends) - static_cast<float>(most));
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
