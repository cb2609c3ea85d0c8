// compression_state.hpp - what the stages of a compression share: the capture as it is open, and what they found so
// far.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compress/bands/map_bands.hpp"
#include "compress/bands/map_set.hpp"
#include "compress/face.hpp"
#include "compress/face_guides.hpp"
#include "compress/importance.hpp"
#include "compress/rate/rate_search.hpp"
#include "compress/search/gram_matrices.hpp"
#include "compress/stage_clock.hpp"
#include "compress/texture_source.hpp"
#include "compress/weight_group.hpp"
#include "facezip/compress.hpp"
#include "io/staged_directory.hpp"
#include "raster/grid_masks.hpp"
#include "raster/texel_masks.hpp"

namespace facezip::compress {

struct CompressionState {
  CompressionState(const Capture& capture, const std::filesystem::path& package, const CompressOptions& options,
                   device::DeviceContext& context, Progress& progress);

  int expressions() const { return static_cast<int>(capture.expressions.size()); }
  int weightSets() const { return static_cast<int>(groups.size()); }
  /// Of the weights as they will be; known before the grid is laid.
  WeightSpace weightSpace() const;
  double coveredTexels(const OpenMap& map) const;

  /// Rows of a band that all maps can have. Throws InputError where --memory is too little.
  int plannedBandRows() const;
  /// The same of the windows of the refinement, in rows of cells.
  int plannedWindowRows(const WeightGroup& group) const;

  /// Runs `visit` on every band of a map, its progress named `stage`. Throws what forEachMapBand() throws.
  void forEachBand(OpenMap& map, const std::string& stage, const MakeTiles& make_tiles,
                   const std::function<void(const MapBand&)>& visit);
  void forEachBand(OpenMap& map, const std::string& stage, const TextureSource& source,
                   const std::function<void(const MapBand&)>& visit);
  /// Puts the painted importance into the texel weights.
  TileMasks weighed(TileMasks tiles, const OpenMap& map, int first_row) const;

  const Capture& capture;
  CompressOptions options;  ///< differences and weight_scale may be chosen on the way
  device::DeviceContext& context;
  Progress& progress;
  io::StagedDirectory staged;
  std::unique_ptr<BandBuffers> buffers;  ///< of passes; made anew where something else needs the memory between
  StageClock clock;
  CompressReport report;
  Face face;
  std::vector<Eigen::MatrixX3f> expression_meshes;  ///< N, some of 0 rows; empty where they are not kept
  FaceMasks masks;
  std::unique_ptr<raster::TexelMasks> texel_masks;
  GramSlots gram_slots;
  MapSet maps;
  raster::GridMasks grid;
  MaskGuides guides;
  std::optional<Importance> importance;
  std::unique_ptr<RateSearch> rates;  ///< where a target or budget was given
  std::vector<WeightGroup> groups;
  std::vector<std::uint64_t> covered_texels;  ///< of every map

 private:
  std::uint64_t residentBytes() const;
};

}  // namespace facezip::compress
