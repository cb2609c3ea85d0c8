// gram_stage.hpp - pass 1: all that the search needs of the texels (FaceZip, Eq. 2 to 4).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "bands/map_bands.hpp"
#include "bands/map_set.hpp"
#include "device/run.hpp"
#include "face/face_model.hpp"
#include "raster/texel_masks.hpp"
#include "search/gram_matrices.hpp"

namespace facezip::compress {

struct GramStage {
  std::vector<GramMatrices> grams;            ///< of all maps together, or of each
  std::vector<double> fit_weights;            ///< of every map, as they are in these
  std::vector<std::uint64_t> covered_texels;  ///< of every map
};

/// Is shown every band of map `index` of the set too.
using ObserveBand = std::function<void(std::size_t index, const MapBand& band)>;

/// Accumulates the Gram matrices of every group of maps. Throws what reading and the device throw, and Cancelled.
/// importance  of texels; may be none
GramStage accumulateGrams(const std::vector<std::vector<GridMap>>& groups, const raster::TexelMasks& masks,
                          const GramSlots& slots, const std::optional<Importance>& importance, int band_rows,
                          const ObserveBand& observe, const device::Run& run);

/// The matrices of all maps together, where `stage` has those of each.
/// maps  with the fit weights that they have among each other
GramMatrices sumOf(const GramStage& stage, const std::vector<GridMap>& maps);

}  // namespace facezip::compress
