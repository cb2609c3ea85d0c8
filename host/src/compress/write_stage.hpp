// write_stage.hpp - pass 3: the package of fitted weights, and the error of what is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "codes/map_codes.hpp"
#include "compress/face_guides.hpp"
#include "compress/fit_stage.hpp"
#include "compress/package_form.hpp"
#include "compress/texture_source.hpp"
#include "device/run.hpp"

namespace facezip::compress {

/// The face as passes that write see it.
struct CoveredFace {
  std::span<const std::uint8_t> cells;    ///< of the weight grid: 1 if the cell has a covered texel
  std::span<const std::uint64_t> texels;  ///< of every map: how many are covered
};

/// Whether the textures of a map are written in blocks.
bool inBlocks(const PackageForm& form, const GridMap& map);

/// The codes of every map of a group, in the group's order.
std::vector<MapCodes> codesOf(const PackageForm& form, const WeightSpace& space, std::span<const GridMap> group,
                              const FittedWeights& fitted, const CoveredFace& face);

/// Squared error of a group as it would be written, fit weights in it, in (1/255)^2. Takes a pass over its maps.
double writtenError(const PackageForm& form, const WeightSpace& space, std::span<const GridMap> group,
                    const FittedWeights& fitted, const CoveredFace& face, int band_rows, const device::Run& run);

/// Textures that follow from the weights of a group as they are; none for those that are fitted.
using DirectTextures = std::function<std::unique_ptr<TextureSource>(std::size_t group)>;

/// What a package is made of.
struct PackageContent {
  const Capture& capture;
  const PackageForm& form;
  const WeightSpace& space;
  const std::vector<std::vector<GridMap>>& groups;
  const std::vector<FittedWeights>& fitted;  ///< of every group
  const CoveredFace& face;
  std::string method_json;
  bool has_mesh = false;  ///< mesh.glb is written beside it
  const MaskGuides& guides;
  DirectTextures direct_textures;
};

/// Writes the package into an empty directory. Returns for every map, where textures were fitted, their squared error
/// over the covered texels as it is written, before frames are rounded, in (1/255)^2.
std::vector<std::optional<double>> writePackage(const PackageContent& content, const std::filesystem::path& directory,
                                                int band_rows, const device::Run& run);

}  // namespace facezip::compress
