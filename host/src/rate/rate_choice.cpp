#include "rate/rate_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "blocks/block_format.hpp"

namespace facezip::compress {

namespace {

/// Bytes of a texture of the map: blocks where it has 8 bits and they are asked for, else `sample_bytes` a sample.
std::uint64_t textureBytes(const RateMap& map, const std::optional<BlockFormat>& format, int sample_bytes) {
  if (format && map.sample_bytes == 1) {
    return blocks::blockBytes(blocks::formatFor(*format, map.channels), map.width, map.height);
  }
  return static_cast<std::uint64_t>(map.width) * static_cast<std::uint64_t>(map.height) *
         static_cast<std::uint64_t>(map.channels * sample_bytes);
}

/// Adds the maps' textures and their error to a point that has the bytes of its weights.
/// scale  index of the point's weight scale
void addMaps(std::span<const RateMap> maps, std::size_t scale, const std::vector<std::vector<double>>& shared_left,
             RatePoint& point) {
  double error = 0.0;
  double samples = 0.0;
  for (const RateMap& map : maps) {
    const bool wide = point.code_bits == 16 && map.sample_bytes > 1;
    const std::vector<double>& left_by_c = shared_left.empty() ? map.left[scale] : shared_left[scale];
    double left = left_by_c[static_cast<std::size_t>(point.differences)];
    left += kRounding / (wide ? 257.0 * 257.0 : 1.0);
    if (point.difference_format && map.sample_bytes == 1) {
      left += point.differences * codingNoise(blocks::formatFor(*point.difference_format, map.channels));
    }
    point.bytes += textureBytes(map, point.texture_format, map.sample_bytes);
    point.bytes +=
        static_cast<std::uint64_t>(point.differences) * textureBytes(map, point.difference_format, wide ? 2 : 1);
    error += map.metric_weight * map.covered_samples * map.mean_square * left;
    samples += map.metric_weight * map.covered_samples;
  }
  point.rmse = samples > 0.0 ? std::sqrt(error / samples) : 0.0;
}

}  // namespace

double codingNoise(BlockFormat format) {
  // Measured on faces of 20 expressions: bench/block_rates.py, differences to the same package as images.
  constexpr double kAtEightBits = 1.9e-3;
  constexpr double kFall = 1.35;
  constexpr double kBc7 = 2.6e-3;
  constexpr double kBc1 = 13.1e-3;
  switch (format) {
    case BlockFormat::kBc1:
      return kBc1;
    case BlockFormat::kBc7:
      return kBc7;
    default: {
      const blocks::BlockFormatInfo& info = blocks::infoOf(format);
      const double bits = 8.0 * info.block_bytes / (info.block_width * info.block_height);
      return kAtEightBits * std::pow(8.0 / bits, kFall);
    }
  }
}

std::vector<RatePoint> rateCurve(std::span<const RateMap> maps, std::span<const int> scales,
                                 std::span<const std::uint64_t> cells, int weight_maps,
                                 std::span<const RateFormats> formats,
                                 const std::vector<std::vector<double>>& shared_left) {
  const bool precise = std::any_of(maps.begin(), maps.end(), [](const RateMap& map) { return map.sample_bytes > 1; });
  std::vector<RatePoint> curve;
  for (const RateFormats& format : formats) {
    for (std::size_t s = 0; s < scales.size(); ++s) {
      for (int c = 1; c <= 8; ++c) {
        for (int bits = 8; bits <= (precise ? 16 : 8); bits += 8) {
          const std::uint64_t weight_bytes = cells[s] * static_cast<std::uint64_t>(c * weight_maps);
          RatePoint point{c, scales[s], bits, format.neutral, format.differences, weight_bytes, 0.0};
          addMaps(maps, s, shared_left, point);
          curve.push_back(point);
        }
      }
    }
  }
  return curve;
}

std::vector<RatePoint> efficientPoints(std::vector<RatePoint> curve) {
  std::stable_sort(curve.begin(), curve.end(), [](const RatePoint& a, const RatePoint& b) {
    return a.bytes != b.bytes ? a.bytes < b.bytes : a.rmse < b.rmse;
  });
  std::vector<RatePoint> efficient;
  double best = std::numeric_limits<double>::infinity();
  for (const RatePoint& point : curve) {
    if (point.rmse >= best) continue;
    best = point.rmse;
    efficient.push_back(point);
  }
  return efficient;
}

bool ownWeightsPay(std::span<const RatePoint> curve, int differences) {
  const RatePoint* own = nullptr;
  const RatePoint* shared = nullptr;
  const RatePoint* neighbour = nullptr;  // one texture more, or less where there are no more
  const int next = differences == 8 ? 7 : differences + 1;
  for (const RatePoint& point : curve) {
    if (point.differences == differences) (point.weights_per_map ? own : shared) = &point;
    if (point.differences == next && !point.weights_per_map) neighbour = &point;
  }
  if (shared->rmse <= 0.0 || neighbour->rmse <= 0.0) return false;  // nothing is left to gain
  const auto bytes = [](const RatePoint* point) { return static_cast<double>(point->bytes); };
  const double share = (bytes(own) - bytes(shared)) / (bytes(neighbour) - bytes(shared));
  return own->rmse < shared->rmse * std::pow(neighbour->rmse / shared->rmse, share);
}

std::optional<RatePoint> chooseRate(std::span<const RatePoint> efficient, std::optional<double> target,
                                    std::optional<std::uint64_t> budget, double calibration) {
  std::optional<RatePoint> chosen;
  for (const RatePoint& point : efficient) {
    if (budget && point.bytes > *budget) break;
    chosen = point;
    if (target && point.rmse * calibration <= *target) return chosen;
  }
  return target ? std::nullopt : chosen;
}

}  // namespace facezip::compress
