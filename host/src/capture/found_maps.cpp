#include "capture/found_maps.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
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

/// The images of a folder. neutral  name of the neutral's
FoundMap readFolder(const fs::path& folder, const std::string& neutral) {
  FoundMap map;
  map.folder = folder;
  map.source = folder;
  for (const fs::directory_entry& entry : entriesOf(folder)) {
    const fs::path& file = entry.path();
    map.has_meshes = map.has_meshes || isMesh(file);
    if (!isImage(file)) continue;
    const std::string name = io::composed(file.stem().string());
    const auto [it, inserted] = map.images.emplace(name == neutral ? kNeutral : name, file);
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

/// What to do about a texture that is missing.
std::string cureFor(const std::string& map_name, const FoundMap& map, const std::vector<std::string>& maps) {
  std::vector<std::string> others = maps;
  std::erase(others, map_name);
  std::string cure = "add it";
  if (!others.empty()) {
    cure += fmt::format(", leave {}/ out with --maps {}", map.folder.filename().string(), fmt::join(others, ","));
  }
  return cure + ", or list expressions and maps in capture.json";
}

}  // namespace

std::map<std::string, FoundMap> findMaps(const fs::path& directory, const CaptureJson& description,
                                         const std::vector<std::string>& wanted, Progress* progress) {
  const std::string neutral = description.neutral.empty() ? kNeutral : description.neutral;
  // A description is complete: folders that it does not name (renders, references) are not maps.
  return description.maps.empty() ? mapsByFolder(directory, wanted, neutral, progress)
                                  : describedMaps(directory, description, neutral);
}

void requireTextures(const std::string& name, const FoundMap& map) {
  std::error_code error;
  if (map.images.empty()) {
    throw InputError({map.folder.string(), fmt::format("map \"{}\"", name), "a folder of textures",
                      fs::exists(map.folder, error) ? "no image in it" : "no such folder",
                      "add the textures, or take the map out of capture.json"});
  }
  if (map.repeated.empty()) return;
  const auto& [expression, files] = *map.repeated.begin();
  throw InputError({map.folder.string(), fmt::format("expression \"{}\"", expression), "one texture", files,
                    "remove or rename one"});
}

CaptureMap makeMap(const std::string& name, const FoundMap& found, const std::vector<std::string>& expressions,
                   const std::vector<std::string>& maps) {
  const auto textureOf = [&](const std::string& expression, const std::string& what) {
    const auto image = found.images.find(expression);
    const bool is_found = image != found.images.end();
    const fs::path file = is_found ? image->second : found.folder / (expression + ".png");
    const std::string fault = is_found ? faultOfFile(file) : "no such file";
    if (fault.empty()) return file;
    throw InputError({file.string(), fmt::format("map \"{}\"", name), what, fault, cureFor(name, found, maps)});
  };
  CaptureMap map;
  map.name = name;
  map.colour_space = found.description.colour_space;
  map.metric_weight = found.description.weight;
  map.neutral = textureOf(kNeutral, "the texture of the neutral");
  for (const std::string& expression : expressions) {
    map.expressions.push_back(textureOf(expression, fmt::format("the texture of expression \"{}\"", expression)));
  }
  return map;
}

}  // namespace facezip
