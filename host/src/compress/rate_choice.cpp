#include "compress/rate_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace facezip::compress {

std::vector<RatePoint> rateCurve(std::span<const RateMap> maps, std::span<const int> scales,
                                 std::span<const std::uint64_t> cells, int expressions) {
  std::vector<RatePoint> curve;
  for (std::size_t s = 0; s < scales.size(); ++s) {
    for (int c = 1; c <= 8; ++c) {
      RatePoint point{c, scales[s], cells[s] * static_cast<std::uint64_t>(c * expressions), 0.0};
      double error = 0.0;
      double samples = 0.0;
      for (const RateMap& map : maps) {
        point.bytes += map.samples * static_cast<std::uint64_t>(map.sample_bytes + c);
        const double left = map.left[s][static_cast<std::size_t>(c)] + kRounding;
        error += map.metric_weight * map.covered_samples * map.mean_square * left;
        samples += map.metric_weight * map.covered_samples;
      }
      point.rmse = samples > 0.0 ? std::sqrt(error / samples) : 0.0;
      curve.push_back(point);
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
