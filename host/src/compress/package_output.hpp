// package_output.hpp - a solution, as files: the last pass over the texels.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bands/map_set.hpp"
#include "codes/coded_neutral.hpp"
#include "codes/map_codes.hpp"
#include "compress/face_guides.hpp"
#include "compress/texture_source.hpp"
#include "device/run.hpp"
#include "facezip/capture.hpp"
#include "refine/grid_weights.hpp"

namespace facezip::compress {

/// What a package holds of one map.
struct MapSolution {
  GridMap map;
  int weight_set = 0;
  MapCodes codes;
  /// Of difference textures as images; may refer to `codes`, which then stay in place.
  std::unique_ptr<TextureSource> textures;
  /// Instead, of a map in blocks: its neutral and its difference textures.
  const CodedNeutral* neutral = nullptr;
  std::unique_ptr<BlockTextures> block_textures;
};

/// What a package is written from, but for the texels.
struct PackageSolution {
  const Capture& capture;
  int differences = 0;                         ///< C
  std::vector<const EncodedWeights*> weights;  ///< of each weight set
  std::vector<MapSolution> maps;               ///< in the order of the capture's
  std::string method_json;
  bool has_mesh = false;  ///< mesh.glb is written beside it
  const MaskGuides& guides;
};

/// Writes the files of a map in blocks: neutral and difference textures, with their mip levels.
/// described  the map with its formats and the names of its files
void writeBlockMap(const MapSolution& solution, const PackageMap& described, const std::filesystem::path& directory,
                   int band_rows, BandBuffers& buffers, const device::Run& run);

/// Writes the files of the package into `directory`, in bands of so many rows.
/// Throws OutputError, and what passes over the texels throw.
void writePackageFiles(const PackageSolution& solution, const std::filesystem::path& directory, int band_rows,
                       const device::Run& run);

}  // namespace facezip::compress
