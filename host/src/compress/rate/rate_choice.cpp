#include "compress/rate/rate_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace facezip::compress {

namespace {

/// Adds the maps' textures and their error to a point that has the bytes of its weights.
/// scale  index of the point's weight scale
void addMaps(std::span<const RateMap> maps, std::size_t scale, const std::vector<std::vector<double>>& shared_left,
             RatePoint& point) {
  double error = 0.0;
  double samples = 0.0;
  for (const RateMap& map : maps) {
    const bool wide = point.code_bits == 16 && map.sample_bytes > 1;
    point.bytes += map.samples * static_cast<std::uint64_t>(map.sample_bytes + point.differences * (wide ? 2 : 1));
    const std::vector<double>& left_by_c = shared_left.empty() ? map.left[scale] : shared_left[scale];
    const double left = left_by_c[static_cast<std::size_t>(point.differences)];
    error +=
        map.metric_weight * map.covered_samples * map.mean_square * (left + kRounding / (wide ? 257.0 * 257.0 : 1.0));
    samples += map.metric_weight * map.covered_samples;
  }
  point.rmse = samples > 0.0 ? std::sqrt(error / samples) : 0.0;
}

}  // namespace

std::vector<RatePoint> rateCurve(std::span<const RateMap> maps, std::span<const int> scales,
                                 std::span<const std::uint64_t> cells, int weight_maps,
                                 const std::vector<std::vector<double>>& shared_left) {
  const bool precise = std::any_of(maps.begin(), maps.end(), [](const RateMap& map) { return map.sample_bytes > 1; });
  std::vector<RatePoint> curve;
  for (std::size_t s = 0; s < scales.size(); ++s) {
    for (int c = 1; c <= 8; ++c) {
      for (int bits = 8; bits <= (precise ? 16 : 8); bits += 8) {
        RatePoint point{c, scales[s], bits, cells[s] * static_cast<std::uint64_t>(c * weight_maps), 0.0};
        addMaps(maps, s, shared_left, point);
        curve.push_back(point);
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
