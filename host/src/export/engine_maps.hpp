// engine_maps.hpp - a package as game engines take it: plain textures of 8 bits, and the numbers of the blend as
// literals.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "facezip/package.hpp"
#include "facezip/progress.hpp"
#include "mesh/map_roles.hpp"

namespace facezip::exporting {

/// D_i of a map, in sampled values: D = scale (sample - zero), in units of full scale, 0 beyond the map's channels.
struct EngineDifference {
  std::array<double, 4> zero{};
  std::array<double, 4> scale{};
};

struct EngineMap {
  std::string id;  ///< the map's name, as shading languages take it
  PackageMap map;
  mesh::MapRole role = mesh::MapRole::kOther;
  std::vector<EngineDifference> differences;  ///< C, of codes of 8 bits
};

/// The maps of 8 and 16 bits: engines take no floats of ours.
std::vector<EngineMap> engineMaps(const Package& package);

/// The blocks of a texture that an engine takes as they are; none: it gets an image. texture  of the map: -1 is the
/// neutral, others are difference textures.
using KeptBlocks = std::optional<BlockFormat> (*)(const PackageMap& map, int texture);
/// Of engines that import no blocks.
inline std::optional<BlockFormat> noBlocks(const PackageMap&, int) { return std::nullopt; }

/// What engines get less of than the package holds: floats are left out, 16 bits become 8, blocks images. A sentence
/// for each map. recoded  what the engine makes of images of blocks, for the sentence
std::vector<std::string> lossesOf(const Package& package, KeptBlocks kept, const std::string& recoded);

/// Throws InputError where engineMaps() found none.
void requireMaps(const Package& package, const std::vector<EngineMap>& maps);

/// Writes textures/ID_neutral.png, 8 bits, rows from the top, nothing recorded that a reader might convert by.
void writeNeutral(const Package& package, const EngineMap& map, const std::filesystem::path& folder,
                  Progress& progress);

/// Writes any texture of the map as NAME.png likewise; of blocks that are kept, its KTX2 file as NAME.fzktx2.
void writeTexture(const Package& package, const EngineMap& map, int texture, KeptBlocks kept,
                  const std::filesystem::path& name, Progress& progress);

/// Where writeStack() puts texture i: column i mod columns, row i div columns.
struct StackLayout {
  int columns = 1;
  int rows = 1;
};
/// Throws InputError naming the map where no image of 16384 x 16384 texels holds all.
StackLayout stackLayout(const Package& package, const EngineMap& map);

/// Writes textures/ID_differences.png: all difference textures in one image, for importers that cut it into layers.
void writeStack(const Package& package, const EngineMap& map, const std::filesystem::path& folder, Progress& progress);

/// Writes textures/weights_SET_FILE.png of every set that the maps use, as the package has it.
void writeWeights(const Package& package, const std::vector<EngineMap>& maps, const std::filesystem::path& folder,
                  Progress& progress);

/// Indices of the sets that the maps use, rising.
std::vector<int> usedSets(const std::vector<EngineMap>& maps);

/// A number as a literal of floats: digits enough to come back, always with a point.
std::string literal(double value);
/// "vec4(1.0, 2.0, 3.0, 4.0)", `type` being vec4 or float4.
std::string literal(const std::string& type, const std::array<double, 4>& values);
/// Four values of a set's scale or offset, from channel 4 file on.
std::array<double, 4> fourOf(const std::vector<double>& values, std::size_t file);

/// What turns a sample of a texture of so many channels into them: gray with alpha is sampled as (g, g, g, a).
/// blocks  of the texture, if it is in blocks: BC5 has red and green
std::string swizzled(const std::string& type, const std::string& sample, int channels,
                     std::optional<BlockFormat> blocks = {});

}  // namespace facezip::exporting
