// rate_estimate.hpp - errors of every number of textures and every weight scale, estimated beside the first pass.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bands/map_bands.hpp"
#include "bands/map_set.hpp"
#include "rate/block_rank_energy.hpp"
#include "rate/rate_choice.hpp"

namespace facezip::compress {

class RateEstimate {
 public:
  /// Throws InputError where the maps can share none of the scales.
  /// further_weight_maps  of each set, beside those of the N expressions
  /// weight_sets  what the curve is to have: packages that share weights, such as have a set for every map, or both
  /// scales  weight scales to look at, rising, each a multiple of the one before
  RateEstimate(const MapSet& maps, int further_weight_maps, WeightSets weight_sets, std::span<const int> scales);

  /// Looks at some of the texels of a band of map `m`; bands in rising order.
  void addBand(std::size_t m, const MapBand& band);

  /// True if none of the texels of map `m` that were looked at changes, and there are others.
  bool sawNothing(std::size_t m) const;

  /// Forgets the bands of map `m`, to look at all of its texels.
  void startOver(std::size_t m);

  /// The curve, when all bands were added.
  std::vector<RatePoint> curve(std::span<const RateFormats> formats) const;

 private:
  void shareGrams();
  std::vector<std::vector<double>> sharedLeft() const;
  std::vector<RateMap> rateMaps() const;
  BlockRankEnergy newEnergies(std::size_t m) const;

  const MapSet& maps_;
  int expressions_;
  int weight_maps_;
  WeightSets weight_sets_;
  std::vector<int> scales_;                ///< of the largest map, rising
  std::vector<std::vector<int>> sides_;    ///< of every map: texels of a block at each scale
  std::vector<BlockRankEnergy> energies_;  ///< of every map
  std::vector<int> strides_;               ///< of every map: one in so many of the largest blocks is looked at
  std::optional<SharedGrams> shared_;      ///< of maps that share weights, where there are several
};

}  // namespace facezip::compress
