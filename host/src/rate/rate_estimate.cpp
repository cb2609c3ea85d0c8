#include "rate/rate_estimate.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "bands/covered_texels.hpp"

namespace facezip::compress {
namespace {

/// One in so many of the largest blocks is looked at. A face of 1024 x 1024 has 900 of them.
constexpr int kStride = 7;

/// The Gram matrices of the smallest blocks that are looked at take no more than this: an odd stride.
int strideToHold(long blocks, const std::vector<int>& sides, int expressions) {
  constexpr double kMostBytes = 32 << 20;
  const double smallest = static_cast<double>(sides.back()) / sides.front();
  const double bytes =
      static_cast<double>(blocks) * smallest * smallest * static_cast<double>(SharedGrams::bytes(expressions));
  return static_cast<int>(std::min(bytes / kMostBytes, 1e6)) | 1;
}

/// None where the maps do not share a grid.
std::optional<std::vector<int>> sharedScales(const MapSet& maps, int scale) {
  try {
    return weightScales(maps, scale);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

RateEstimate::RateEstimate(const MapSet& maps, int further_weight_maps, WeightSets weight_sets,
                           std::span<const int> scales)
    : maps_(maps),
      expressions_(maps.maps.front().samples->expressions()),
      weight_maps_(expressions_ + further_weight_maps),
      weight_sets_(weight_sets) {
  const bool shares = weight_sets != WeightSets::kPerMap && maps.maps.size() > 1;
  sides_.resize(maps.maps.size());
  for (const int scale : scales) {
    const std::optional<std::vector<int>> of_maps = sharedScales(maps, scale);
    if (!of_maps) continue;
    scales_.push_back(scale);
    for (std::size_t m = 0; m < maps.maps.size(); ++m) sides_[m].push_back((*of_maps)[m]);
  }
  if (scales_.empty()) weightScales(maps, scales.front());  // says what does not fit
  for (std::size_t m = 0; m < maps.maps.size(); ++m) {
    const image::ImageShape& shape = maps.maps[m].samples->shape();
    const long side = sides_[m].back();
    const long blocks = (shape.width / side + 1) * (shape.height / side + 1);
    strides_.push_back(blocks > 16L * kStride ? kStride : 1);
    if (shares) strides_.back() = std::max(strides_.back(), strideToHold(blocks, sides_[m], expressions_));
    energies_.push_back(newEnergies(m));
  }
  if (shares) shareGrams();
}

void RateEstimate::shareGrams() {
  shared_.emplace(energies_.front().smallestBlocks(), expressions_);
  for (std::size_t m = 0; m < energies_.size(); ++m) energies_[m].shareWith(*shared_, maps_.maps[m].metric_weight);
}

std::vector<std::vector<double>> RateEstimate::sharedLeft() const {
  std::vector<std::vector<double>> left;
  if (!shared_) return left;
  for (const RankEnergy& energy : energies_.front().energiesOf(*shared_)) {
    const double whole = energy.residual[0];
    std::vector<double>& of_scale = left.emplace_back();
    for (const double residual : energy.residual) of_scale.push_back(whole > 0.0 ? residual / whole : 0.0);
  }
  return left;
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
  shared_.reset();  // of other blocks: each map is estimated alone, which is little where one hardly changes
  energies_[m] = newEnergies(m);
}

void RateEstimate::addBand(std::size_t m, const MapBand& band) {
  energies_[m].addBand(band.begin, band.samples, band.shape, coveredTexels(band.shape, band.masks));
}

std::vector<RateMap> RateEstimate::rateMaps() const {
  std::vector<RateMap> maps;
  for (std::size_t m = 0; m < maps_.maps.size(); ++m) {
    const image::ImageShape& shape = maps_.maps[m].samples->shape();
    RateMap map;
    map.width = shape.width;
    map.height = shape.height;
    map.channels = shape.channels;
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
  return maps;
}

std::vector<RatePoint> RateEstimate::curve(std::span<const RateFormats> formats) const {
  const std::vector<RateMap> maps = rateMaps();
  std::vector<std::uint64_t> cells;
  const image::ImageShape& reference = maps_.maps[maps_.reference].samples->shape();
  for (const int scale : scales_) {
    cells.push_back(static_cast<std::uint64_t>((reference.width + scale - 1) / scale) *
                    static_cast<std::uint64_t>((reference.height + scale - 1) / scale));
  }
  std::vector<RatePoint> curve;
  if (weight_sets_ != WeightSets::kPerMap || maps.size() == 1) {
    curve = rateCurve(maps, scales_, cells, weight_maps_, formats, sharedLeft());
  }
  if (weight_sets_ == WeightSets::kShared || maps.size() == 1) return curve;
  for (std::uint64_t& of_scale : cells) of_scale *= maps.size();
  for (RatePoint& point : rateCurve(maps, scales_, cells, weight_maps_, formats)) {
    point.weights_per_map = true;
    curve.push_back(point);
  }
  return curve;
}

}  // namespace facezip::compress
