#include "capture/found_maps.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <system_error>

#include "facezip/input_file.hpp"
#include "image/input_extensions.hpp"
#include "io/composed.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

using Maps = std::map<std::string, FoundMap>;

constexpr const char* kNeutral = "neutral";

/// By its name: what has one and is no file must not be left out, or its expression would be.
bool isImage(const fs::path& path) { return image::hasImageExtension(path); }

bool isMesh(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension == ".obj";
}

/// What a folder holds, by name. A name that starts with a dot is the desktop's or an unfinished copy.
std::vector<fs::directory_entry> entriesOf(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::directory_entry> entries;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (entry->path().filename().string().front() != '.') entries.push_back(*entry);
  }
  if (error) {
    throw InputError({folder.string(), "", "a folder that can be read", error.message(), "check its permissions"});
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// Takes the tile off a name: "neutral.1001" is the neutral's in tile 1001.
std::optional<int> takeTile(std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0 || name.size() != dot + 5) return std::nullopt;
  const std::string digits = name.substr(dot + 1);
  if (!std::ranges::all_of(digits, [](char c) { return '0' <= c && c <= '9'; })) return std::nullopt;
  const int tile = std::stoi(digits);
  if (tile < kFirstTile || tile > kLastTile) return std::nullopt;
  name.erase(dot);
  return tile;
}

/// The images of a folder. neutral  name of the neutral's
FoundMap readFolder(const fs::path& folder, const std::string& neutral) {
  FoundMap map;
  map.folder = folder;
  map.source = folder;
  for (const fs::directory_entry& entry : entriesOf(folder)) {
    const fs::path& file = entry.path();
    map.has_meshes = map.has_meshes || isMesh(file);
    if (!isImage(file)) continue;
    std::string name = io::composed(file.stem().string());
    const std::optional<int> tile = takeTile(name);
    if (name == neutral) name = kNeutral;
    if (tile && map.tiles[*tile].emplace(name, file).second) {
      map.images.emplace(name, file);  // until a tile is chosen
      continue;
    }
    const auto [it, inserted] = map.images.emplace(name, file);
    if (inserted) continue;
    std::string& files = map.repeated.try_emplace(it->first, it->second.filename().string()).first->second;
    files += " and " + file.filename().string();
  }
  return map;
}

/// The folders of a capture by name.
std::map<std::string, fs::path> foldersOf(const fs::path& directory) {
  std::map<std::string, fs::path> folders;
  for (const fs::directory_entry& entry : entriesOf(directory)) {
    std::error_code ignored;
    if (entry.is_directory(ignored)) folders.emplace(io::composed(entry.path().filename().string()), entry.path());
  }
  return folders;
}

Maps describedMaps(const fs::path& directory, const CaptureJson& description, const std::string& neutral) {
  const std::map<std::string, fs::path> folders = foldersOf(directory);
  Maps maps;
  for (const auto& [name, map] : description.maps) {
    fs::path folder = directory / (map.folder.empty() ? name : map.folder);
    if (map.folder.empty() && folders.contains(name)) folder = folders.at(name);
    std::error_code ignored;
    FoundMap found = fs::is_directory(folder, ignored) ? readFolder(folder, neutral) : FoundMap{};
    found.description = map;
    found.folder = folder;
    found.source = directory / kCaptureFile;
    if (!map.neutral.empty()) found.images[kNeutral] = directory / map.neutral;
    for (const auto& [expression, file] : map.expressions) found.images[expression] = directory / file;
    maps.emplace(name, std::move(found));
  }
  return maps;
}

/// Is this a map, where others are? A map that lacks its neutral is one that somebody must mend.
bool isMapBeside(const FoundMap& map, const Maps& certain) {
  if (map.has_meshes) return false;
  return std::any_of(certain.begin(), certain.end(), [&](const auto& other) {
    return std::any_of(map.images.begin(), map.images.end(), [&](const auto& image) {
      return image.first != kNeutral && other.second.images.contains(image.first);
    });
  });
}

Maps mapsByFolder(const fs::path& directory, const std::vector<std::string>& wanted, const std::string& neutral,
                  Progress* progress) {
  Maps found, certain;
  for (const auto& [name, folder] : foldersOf(directory)) {
    FoundMap map = readFolder(folder, neutral);
    if (map.images.empty()) continue;
    if (map.images.contains(kNeutral) && !map.has_meshes) certain.emplace(name, map);
    found.emplace(name, std::move(map));
  }
  if (certain.empty()) return found;
  for (auto it = found.begin(); it != found.end();) {
    const auto& [name, map] = *it;
    const bool taken = certain.contains(name) || std::ranges::find(wanted, name) != wanted.end();
    if (taken || isMapBeside(map, certain)) {
      ++it;
      continue;
    }
    if (progress != nullptr && wanted.empty()) {
      progress->note(fmt::format("{}: its images are no map's, {}; --maps {} takes them", map.folder.string(),
                                 map.has_meshes ? "since meshes are there" : "since none is the neutral's", name));
    }
    it = found.erase(it);
  }
  return found;
}

/// What to do about a texture that a map lacks. Where fewer maps have one than not, those are in the way, else this
/// one.
std::string cureFor(const std::string& name, const std::string& expression, const Maps& maps) {
  std::vector<std::string> have, lack, others;
  for (const auto& [map_name, map] : maps) {
    (map.images.contains(expression) ? have : lack).push_back(map_name);
    if (map_name != name) others.push_back(map_name);
  }
  const bool others_are = !have.empty() && have.size() < lack.size();
  const std::vector<std::string> left_out = others_are ? have : std::vector{name};
  const std::vector<std::string>& taken = others_are ? lack : others;
  std::string cure = "add it";
  if (!taken.empty()) {
    cure += fmt::format(", leave {}/ out with --maps {}", fmt::join(left_out, "/ and "), fmt::join(taken, ","));
  }
  return cure + ", or list expressions and maps in capture.json";
}

std::string whatIs(const std::string& expression) {
  return expression == kNeutral ? "the texture of the neutral"
                                : fmt::format("the texture of expression \"{}\"", expression);
}

fs::path textureOf(const std::string& name, const std::string& expression, const Maps& maps) {
  const FoundMap& map = maps.at(name);
  const auto image = map.images.find(expression);
  const bool is_found = image != map.images.end();
  const fs::path file = is_found ? image->second : map.folder / (expression + ".png");
  const std::string fault = is_found ? faultOfFile(file) : "no such file";
  if (fault.empty()) return file;
  throw InputError(
      {file.string(), fmt::format("map \"{}\"", name), whatIs(expression), fault, cureFor(name, expression, maps)});
}

}  // namespace

std::map<std::string, FoundMap> findMaps(const fs::path& directory, const CaptureJson& description,
                                         const std::vector<std::string>& wanted, Progress* progress) {
  const std::string neutral = description.neutral.empty() ? kNeutral : description.neutral;
  // A description is complete: folders that it does not name (renders, references) are not maps.
  return description.maps.empty() ? mapsByFolder(directory, wanted, neutral, progress)
                                  : describedMaps(directory, description, neutral);
}

void requireTextures(const Maps& maps) {
  for (const auto& [name, map] : maps) {
    std::error_code error;
    if (map.images.empty()) {
      throw InputError({map.folder.string(), fmt::format("map \"{}\"", name), "a folder of textures",
                        fs::exists(map.folder, error) ? "no image in it" : "no such folder",
                        "add the textures, or take the map out of capture.json"});
    }
    if (!map.repeated.empty()) {
      const auto& [expression, files] = *map.repeated.begin();
      throw InputError({map.folder.string(), fmt::format("expression \"{}\"", expression), "one texture", files,
                        "remove or rename one"});
    }
    textureOf(name, kNeutral, maps);  // before expressions that this map alone may have
  }
}

CaptureMap makeMap(const std::string& name, const Maps& maps, const std::vector<std::string>& expressions) {
  CaptureMap map;
  map.name = name;
  map.colour_space = maps.at(name).description.colour_space;
  map.metric_weight = maps.at(name).description.weight;
  map.neutral = textureOf(name, kNeutral, maps);
  for (const std::string& expression : expressions) map.expressions.push_back(textureOf(name, expression, maps));
  return map;
}

std::optional<int> chooseTile(const fs::path& directory, std::optional<int> wanted, Maps& maps) {
  std::set<int> tiles;
  for (const auto& [name, map] : maps) {
    for (const auto& [tile, images] : map.tiles) tiles.insert(tile);
  }
  if (tiles.empty() && !wanted) return std::nullopt;
  if (wanted ? !tiles.contains(*wanted) : tiles.size() > 1) {
    throw InputError({directory.string(), "tiles",
                      wanted ? fmt::format("textures of tile {}", *wanted) : "textures of one",
                      tiles.empty() ? "none that name a tile" : fmt::format("those of {}", fmt::join(tiles, ", ")),
                      fmt::format("choose one by \"tile\" in {}: each makes a package of its own", kCaptureFile)});
  }
  const int tile = wanted.value_or(*tiles.begin());
  for (auto& [name, map] : maps) {
    for (const auto& [other, images] : map.tiles) {
      for (const auto& [image, file] : images) {
        if (other != tile && map.images[image] == file) map.images.erase(image);
      }
    }
    if (!map.tiles.contains(tile)) continue;
    for (const auto& [image, file] : map.tiles.at(tile)) map.images[image] = file;
  }
  return tile;
}

}  // namespace facezip
