// package_output.hpp - a solution, as files: the last pass over the texels.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "compress/bands/map_bands.hpp"
#include "compress/bands/map_set.hpp"
#include "compress/face_guides.hpp"
#include "compress/refine/grid_weights.hpp"
#include "compress/texture_source.hpp"
#include "facezip/capture.hpp"

namespace facezip::compress {

/// What a package holds of one map.
struct MapSolution {
  OpenMap* map = nullptr;
  int weight_set = 0;
  std::vector<TextureEncoding> encoding;  ///< C x channels
  int bits = 8;                           ///< of the codes of difference textures
  TextureSource* source = nullptr;
};

struct PackageSolution {
  int differences = 0;                  ///< C
  std::vector<EncodedWeights> weights;  ///< of each weight set
  std::vector<MapSolution> maps;
  std::string method_json;
  bool has_mesh = false;  ///< mesh.glb is written beside it
  MaskGuides guides;
};

/// Runs a pass over the bands of a map with the tiles of `source`.
using BandPass =
    std::function<void(OpenMap& map, TextureSource& source, const std::function<void(const MapBand&)>& visit)>;

/// Writes the files of the package into `directory`. Throws OutputError, and what the pass throws.
void writePackage(device::DeviceContext& context, const Capture& capture, const PackageSolution& solution,
                  const BandPass& pass, const std::filesystem::path& directory);

}  // namespace facezip::compress
