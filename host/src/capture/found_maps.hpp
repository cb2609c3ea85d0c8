// found_maps.hpp - which images of a capture are the textures of its maps.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture_json.hpp"
#include "facezip/capture.hpp"
#include "facezip/progress.hpp"

namespace facezip {

/// The textures of one map before the expressions' order is known.
struct FoundMap {
  CaptureJson::Map description;
  std::filesystem::path folder;
  std::filesystem::path source;                         ///< what names the map: its folder, or capture.json
  std::map<std::string, std::filesystem::path> images;  ///< by expression; the neutral's is "neutral"
  std::map<std::string, std::string> repeated;          ///< names that several images have: "a.png and a.tif"
  bool has_meshes = false;
  std::map<int, std::map<std::string, std::filesystem::path>> tiles;  ///< the images again, of NAME.1001.EXT and such
};

inline constexpr int kLastTile = 1999;

/// The tile of the maps' textures; none where they have no tiles. Their `images` are then that tile's.
/// wanted  what capture.json says. Throws InputError: several and none is wanted, or another one.
std::optional<int> chooseTile(const std::filesystem::path& directory, std::optional<int> wanted,
                              std::map<std::string, FoundMap>& maps);

/// The maps that capture.json names; where it names none, the folders of images. Those of previews and references are
/// left out: folders without a neutral whose images have the names of no map's, and folders of meshes, where others
/// are maps.
/// wanted    is taken for a map in any case, if it is a folder; empty: any
/// progress  notes what is left out where `wanted` is empty; may be null
/// Throws InputError for a folder that cannot be read.
std::map<std::string, FoundMap> findMaps(const std::filesystem::path& directory, const CaptureJson& description,
                                         const std::vector<std::string>& wanted, Progress* progress);

/// Throws InputError for one of the maps that has no textures, no neutral or several textures of one name.
void requireTextures(const std::map<std::string, FoundMap>& maps);

/// The files of map `name` of `maps`. expressions  N, as the capture orders them
/// Throws InputError for a texture that is not there, or is no file, naming what leaves it out.
CaptureMap makeMap(const std::string& name, const std::map<std::string, FoundMap>& maps,
                   const std::vector<std::string>& expressions);

}  // namespace facezip
