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
  /// Finds the weight scales, of 4, 8, 16 and 32, that all maps can share. Throws InputError where there is none.
  /// further_weight_maps  of each set, beside those of the N expressions
  /// weight_sets  1, or one for every map
  RateEstimate(const MapSet& maps, int further_weight_maps, int weight_sets);

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
  BlockRankEnergy newEnergies(std::size_t m) const;

  const MapSet& maps_;
  int expressions_;
  int weight_maps_;
  int weight_sets_;
  std::vector<int> scales_;                ///< of the largest map, rising
  std::vector<std::vector<int>> sides_;    ///< of every map: texels of a block at each scale
  std::vector<BlockRankEnergy> energies_;  ///< of every map
  std::vector<int> strides_;               ///< of every map: one in so many of the largest blocks is looked at
  std::optional<SharedGrams> shared_;      ///< of maps that share weights, where there are several
};

}  // namespace facezip::compress
