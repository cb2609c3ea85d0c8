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
  return clippedRange(findPerTile(tiles, shape, textures, first, end), planes, 0.0);
}

namespace {

/// Ranges widened until no tile reaches beyond by more than it may, or they are kMostWidening wider: a texture of a few
/// far texels would have coarse codes for all others.
std::vector<TextureRange> unclamped(std::span<const TextureRange> tiles, const std::vector<TextureRange>& ranges,
                                    std::span<const float> most) {
  constexpr float kMostWidening = 0.75f;
  std::vector<TextureRange> result = ranges;
  for (std::size_t i = 0; i < most.size(); ++i) {
    TextureRange& range = result[i % ranges.size()];
    range.min = std::min(range.min, tiles[i].min + most[i]);
    range.max = std::max(range.max, tiles[i].max - most[i]);
  }
  for (std::size_t plane = 0; plane < ranges.size(); ++plane) {
    const float room = 0.5f * kMostWidening * (ranges[plane].max - ranges[plane].min);
    result[plane].min = std::max(result[plane].min, ranges[plane].min - room);
    result[plane].max = std::min(result[plane].max, ranges[plane].max + room);
  }
  return result;
}

}  // namespace

std::vector<TextureRange> clippedRange(std::span<const TextureRange> tiles, std::size_t planes, double clipped,
                                       std::span<const float> most) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<TextureRange> result(planes, {kInfinity, -kInfinity});
  const std::size_t count = tiles.size() / planes;
  const auto beyond = static_cast<std::size_t>(clipped * static_cast<double>(count));
  if (count == 0) return result;
  std::vector<float> ends(count);
  for (std::size_t plane = 0; plane < planes; ++plane) {
    for (std::size_t t = 0; t < count; ++t) ends[t] = tiles[t * planes + plane].min;
    std::nth_element(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(beyond), ends.end());
    result[plane].min = ends[beyond];
    for (std::size_t t = 0; t < count; ++t) ends[t] = tiles[t * planes + plane].max;
    std::nth_element(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(beyond), ends.end(), std::greater<>());
    result[plane].max = ends[beyond];
  }
  return most.empty() ? result : unclamped(tiles, result, most);
}

void widen(std::vector<TextureRange>& whole, std::span<const TextureRange> part) {
  if (whole.empty()) whole.assign(part.begin(), part.end());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    whole[i].min = std::min(whole[i].min, part[i].min);
    whole[i].max = std::max(whole[i].max, part[i].max);
  }
}

}  // namespace facezip::compress
