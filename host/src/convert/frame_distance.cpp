#include "convert/frame_distance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "io/counts.hpp"
#include "raster/tiles.hpp"

namespace facezip::convert {
namespace {
using raster::kTileSide;

constexpr int kRowsAtOnce = 64;

/// Places of the samples of covered texels in rows [begin, end).
std::vector<std::size_t> coveredSamples(const raster::TexelClasses& classes, int channels, int begin, int end) {
  std::vector<std::size_t> samples;
  for (int y = begin; y < end; ++y) {
    for (int x = 0; x < classes.width(); ++x) {
      if ((classes.covered(x / kTileSide, y) >> (x % kTileSide) & 1u) == 0) continue;
      const std::size_t first = (toSize(y - begin, classes.width()) + toSize(x)) * toSize(channels);
      for (std::size_t c = 0; c < toSize(channels); ++c) samples.push_back(first + c);
    }
  }
  return samples;
}

}  // namespace

double frameDistance(const DecodedPackage& a, const DecodedPackage& b, int map_index,
                     const raster::TexelClasses& classes, const Device& device, Progress& progress) {
  const PackageMap& map = a.package.maps()[toSize(map_index)];
  blend::BandBlender of_a(a.package, map_index, a.weights, device);
  blend::BandBlender of_b(b.package, map_index, b.weights, device);
  std::vector<float> beta(a.package.expressions().size(), 0.0f);
  std::vector<float> values_a, values_b;
  double sum = 0.0, count = 0.0;
  progress.stage("comparing: " + map.name, toSize(map.height));
  for (int begin = 0; begin < map.height; begin += kRowsAtOnce) {
    const int end = std::min(begin + kRowsAtOnce, map.height);
    of_a.loadRows(begin, end);
    of_b.loadRows(begin, end);
    const std::vector<std::size_t> samples = coveredSamples(classes, map.channels, begin, end);
    values_a.resize(toSize(end - begin, map.width, map.channels));
    values_b.resize(values_a.size());
    for (float& one : beta) {
      progress.checkCancelled();
      if (samples.empty()) break;
      one = 1.0f;
      of_a.blendValues(beta, values_a);
      of_b.blendValues(beta, values_b);
      one = 0.0f;
      for (const std::size_t s : samples) {
        const double difference = static_cast<double>(values_a[s]) - static_cast<double>(values_b[s]);
        sum += difference * difference;
      }
      count += static_cast<double>(samples.size());
    }
    progress.advance(toSize(end));
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace facezip::convert
