#include "compress/rate/rate_estimate.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "compress/bands/covered_texels.hpp"

namespace facezip::compress {
namespace {

constexpr int kScales[] = {4, 8, 16, 32};
/// One in so many of the largest blocks is looked at. A face of 1024 x 1024 has 900 of them.
constexpr int kStride = 7;

/// None where the maps do not share a grid.
std::optional<std::vector<int>> sharedScales(const MapSet& maps, int scale) {
  try {
    return weightScales(maps, scale);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

RateEstimate::RateEstimate(const MapSet& maps, int further_weight_maps)
    : maps_(maps),
      expressions_(maps.maps.front().samples->expressions()),
      weight_maps_(expressions_ + further_weight_maps) {
  sides_.resize(maps.maps.size());
  for (const int scale : kScales) {
    const std::optional<std::vector<int>> of_maps = sharedScales(maps, scale);
    if (!of_maps) continue;
    scales_.push_back(scale);
    for (std::size_t m = 0; m < maps.maps.size(); ++m) sides_[m].push_back((*of_maps)[m]);
  }
  if (scales_.empty()) weightScales(maps, kScales[0]);  // says what does not fit
  for (std::size_t m = 0; m < maps.maps.size(); ++m) {
    const image::ImageShape& shape = maps.maps[m].samples->shape();
    const long side = sides_[m].back();
    const long blocks = (shape.width / side + 1) * (shape.height / side + 1);
    strides_.push_back(blocks > 16L * kStride ? kStride : 1);
    energies_.push_back(newEnergies(m));
  }
}

BlockRankEnergy RateEstimate::newEnergies(std::size_t m) const {
  const image::ImageShape& shape = maps_.maps[m].samples->shape();
  return {sides_[m], shape.width, shape.height, shape.channels, expressions_, strides_[m]};
}

bool RateEstimate::sawNothing(std::size_t m) const {
  return strides_[m] > 1 && energies_[m].energies().front().residual[0] == 0.0;
}

void RateEstimate::startOver(std::size_t m) {
  strides_[m] = 1;
  energies_[m] = newEnergies(m);
}

void RateEstimate::addBand(std::size_t m, const MapBand& band) {
  energies_[m].addBand(band.begin, band.samples, band.shape, coveredTexels(band.shape, band.masks));
}

std::vector<RatePoint> RateEstimate::curve(int weight_sets) const {
  std::vector<RateMap> maps;
  for (std::size_t m = 0; m < maps_.maps.size(); ++m) {
    const image::ImageShape& shape = maps_.maps[m].samples->shape();
    RateMap map;
    map.samples = static_cast<std::uint64_t>(shape.height) * shape.rowBytes() / image::sampleBytes(shape.type);
    map.sample_bytes = static_cast<int>(image::sampleBytes(shape.type));
    map.metric_weight = maps_.maps[m].metric_weight;
    for (const RankEnergy& energy : energies_[m].energies()) {
      const double whole = energy.residual[0];
      std::vector<double>& left = map.left.emplace_back();
      for (const double residual : energy.residual) left.push_back(whole > 0.0 ? residual / whole : 0.0);
      map.covered_samples = static_cast<double>(energy.texels) * shape.channels * expressions_;
      map.mean_square = map.covered_samples > 0.0 ? whole / map.covered_samples : 0.0;
    }
    map.covered_samples *= strides_[m];  // maps may be looked at more or less closely
    maps.push_back(std::move(map));
  }
  std::vector<std::uint64_t> cells;
  const image::ImageShape& reference = maps_.maps[maps_.reference].samples->shape();
  for (const int scale : scales_) {
    cells.push_back(static_cast<std::uint64_t>((reference.width + scale - 1) / scale) *
                    static_cast<std::uint64_t>((reference.height + scale - 1) / scale) *
                    static_cast<std::uint64_t>(weight_sets));
  }
  return rateCurve(maps, scales_, cells, weight_maps_);
}

}  // namespace facezip::compress
