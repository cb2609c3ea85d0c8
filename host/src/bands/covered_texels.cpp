#include "bands/covered_texels.hpp"

#include <cassert>

#include "io/counts.hpp"

namespace facezip::compress {
namespace {

template <typename Sample>
void convert(std::span<const std::byte> samples, float unit, std::span<float> out) {
  const auto* typed = reinterpret_cast<const Sample*>(samples.data());
  forEachChunk(out.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = unit * static_cast<float>(typed[i]);
  });
}

}  // namespace

std::vector<std::uint32_t> coveredTexels(const BandShape& shape, const TileMasks& covered) {
  std::vector<std::uint32_t> texels;
  for (std::size_t t = 0; t < covered.tiles.size(); ++t) {
    const float* weights = covered.texel_weights.data() + t * kTileTexels;
    for (int i = 0; i < kTileTexels; ++i) {
      const int x = covered.tiles[t].x * kTileSide + i % kTileSide;
      const int y = covered.tiles[t].y * kTileSide + i / kTileSide;
      if (weights[i] <= 0.0f || x >= shape.width || y >= shape.rows) continue;
      texels.push_back(static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(shape.width) +
                       static_cast<std::uint32_t>(x));
    }
  }
  std::sort(texels.begin(), texels.end());  // tile by tile before: rows stream better through the caches
  return texels;
}

void toValues(std::span<const std::byte> samples, image::SampleType type, std::span<float> out) {
  assert(samples.size() == out.size() * image::sampleBytes(type));
  const float unit = image::unit255(type);
  switch (type) {
    case image::SampleType::kUint8:
      return convert<std::uint8_t>(samples, unit, out);
    case image::SampleType::kUint16:
      return convert<std::uint16_t>(samples, unit, out);
    case image::SampleType::kFloat32:
      break;
  }
  convert<float>(samples, unit, out);
}

std::span<const std::byte> bandImage(std::span<const std::byte> samples, const BandShape& shape, int image) {
  const std::size_t bytes = samples.size() / toSize(shape.expressions + 1);
  return samples.subspan(toSize(image) * bytes, bytes);
}

}  // namespace facezip::compress
