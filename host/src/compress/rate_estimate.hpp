// rate_estimate.hpp - errors of every number of textures and every weight scale, estimated beside the first pass.
#pragma once

#include <memory>
#include <vector>

#include "compress/block_rank_energy.hpp"
#include "compress/map_bands.hpp"
#include "compress/map_set.hpp"
#include "compress/rate_choice.hpp"

namespace facezip::compress {

class RateEstimate {
 public:
  /// Finds the weight scales, of 4, 8, 16 and 32, that all maps can share. Throws InputError where there is none.
  RateEstimate(MapSet& maps, int expressions);

  /// Looks at some of the texels of a band of map `m`; bands in rising order.
  void addBand(std::size_t m, const MapBand& band);

  /// The curve, when all bands were added.
  /// weight_sets  1, or one for every map
  std::vector<RatePoint> curve(int weight_sets) const;

  int finestScale() const { return scales_.front(); }

 private:
  const MapSet& maps_;
  int expressions_;
  std::vector<int> scales_;                ///< of the largest map, rising
  std::vector<BlockRankEnergy> energies_;  ///< of every map, blocks at each scale
};

}  // namespace facezip::compress
