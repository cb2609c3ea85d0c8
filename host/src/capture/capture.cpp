#include "facezip/capture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "capture/capture_json.hpp"
#include "capture/expression_meshes.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/input_file.hpp"
#include "image/input_extensions.hpp"
#include "package/package_json.hpp"
#include "package/safe_names.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

constexpr const char* kCaptureFile = "capture.json";

/// By its name: what has one and is no file must not be left out, or its expression would be. A name that starts with a
/// dot is the desktop's or an unfinished copy, not a texture.
bool isImage(const fs::path& path) { return image::hasImageExtension(path) && path.filename().string().front() != '.'; }

/// What a folder holds, by name.
std::vector<fs::directory_entry> entriesOf(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::directory_entry> entries;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    entries.push_back(*entry);
  }
  if (error) {
    throw InputError({folder.string(), "", "a folder that can be read", error.message(), "check its permissions"});
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// Image files of a folder by stem. Two files with the same stem would be two textures of one expression.
std::map<std::string, fs::path> imagesByName(const fs::path& folder) {
  std::map<std::string, fs::path> images;
  for (const fs::directory_entry& entry : entriesOf(folder)) {
    if (!isImage(entry.path())) continue;
    const auto [it, inserted] = images.emplace(entry.path().stem().string(), entry.path());
    if (inserted) continue;
    std::set<std::string> both = {it->second.filename().string(), entry.path().filename().string()};
    throw InputError({folder.string(), fmt::format("expression \"{}\"", it->first), "one texture",
                      fmt::format("{}", fmt::join(both, " and ")), "remove or rename one"});
  }
  return images;
}

/// The textures of one map before the expressions' order is known.
struct FoundMap {
  CaptureJson::Map description;
  fs::path folder;
  fs::path source;  ///< what names the map: its folder, or capture.json
  std::map<std::string, fs::path> images;
};

std::map<std::string, FoundMap> findMaps(const fs::path& directory, const CaptureJson& description) {
  std::map<std::string, FoundMap> maps;
  for (const fs::directory_entry& entry : entriesOf(directory)) {
    const std::string name = entry.path().filename().string();
    std::error_code ignored;
    if (!entry.is_directory(ignored) || name.front() == '.') continue;
    const bool described = description.maps.contains(name);
    // A description is complete: folders that it does not name (renders, references) are not maps.
    if (!described && !description.maps.empty()) continue;
    std::map<std::string, fs::path> images = imagesByName(entry.path());
    if (!described && images.empty()) continue;
    maps[name] = {described ? description.maps.at(name) : CaptureJson::Map{}, entry.path(), entry.path(),
                  std::move(images)};
  }
  for (const auto& [name, map] : description.maps) {
    FoundMap& found = maps.try_emplace(name, FoundMap{map, directory / name, {}, {}}).first->second;
    found.source = directory / kCaptureFile;
    if (!map.neutral.empty()) found.images["neutral"] = directory / map.neutral;
    for (const auto& [expression, file] : map.expressions) found.images[expression] = directory / file;
  }
  return maps;
}

/// A map that capture.json names may have no folder, or an empty one.
void requireTextures(const std::string& name, const FoundMap& map) {
  if (!map.images.empty()) return;
  std::error_code error;
  throw InputError({map.folder.string(), fmt::format("map \"{}\"", name), "a folder of textures",
                    fs::exists(map.folder, error) ? "no image in it" : "no such folder",
                    "add the textures, or take the map out of capture.json"});
}

void requireUnique(const std::vector<std::string>& names, const fs::path& file) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (seen.insert(name).second) continue;
    throw InputError(
        {file.string(), fmt::format("expression \"{}\"", name), "unique names", "the same name twice", "rename one"});
  }
}

/// Refuses here what the package would refuse when all the work is done.
void requireName(const std::string& name, const char* item, const fs::path& file, const std::string& further = "") {
  const auto fault = package::nameFault(name, further);
  if (fault) throw InputError({file.string(), item, fault->expected, fault->got, "rename it"});
}

/// The expressions' names: capture.json's order, else every image name that any map has, sorted.
std::vector<std::string> expressionNames(const fs::path& directory, const CaptureJson& description,
                                         const std::map<std::string, FoundMap>& maps) {
  std::vector<std::string> names = description.expressions;
  std::map<std::string, fs::path> found;  // with the first image of each
  if (names.empty()) {
    for (const auto& [map_name, map] : maps) found.insert(map.images.begin(), map.images.end());
    found.erase("neutral");
    for (const auto& [name, image] : found) names.push_back(name);
  }
  requireUnique(names, directory / kCaptureFile);
  for (const std::string& name : names) {  // commas and equals signs part names and weights on the command line
    requireName(name, "expression", found.contains(name) ? found.at(name) : directory / kCaptureFile, ",=");
  }
  if (names.empty()) {
    throw InputError({directory.string(), "expressions", "at least one expression beside the neutral", "none",
                      "add MAP/NAME.png for every expression"});
  }
  return names;
}

fs::path textureOf(const FoundMap& map, const std::string& map_name, const std::string& name) {
  const auto found = map.images.find(name);
  const fs::path file = found != map.images.end() ? found->second : map.folder / (name + ".png");
  const std::string fault = faultOfFile(file);
  if (fault.empty() && found != map.images.end()) return file;
  throw InputError(
      {file.string(), fmt::format("map \"{}\"", map_name),
       name == "neutral" ? "the texture of the neutral" : fmt::format("the texture of expression \"{}\"", name),
       fault.empty() ? "no such file" : fault, "add the texture, or take the map or expression out"});
}

CaptureMap makeMap(const std::string& name, const FoundMap& found, const std::vector<std::string>& expressions) {
  CaptureMap map;
  map.name = name;
  map.colour_space = found.description.colour_space;
  map.metric_weight = found.description.weight;
  map.neutral = textureOf(found, name, "neutral");
  for (const std::string& expression : expressions) map.expressions.push_back(textureOf(found, name, expression));
  return map;
}

std::vector<std::string> chooseMaps(const fs::path& directory, const std::map<std::string, FoundMap>& found,
                                    const std::vector<std::string>& wanted) {
  std::vector<std::string> names;
  for (const auto& [name, map] : found) names.push_back(name);
  if (names.empty()) {
    throw InputError({directory.string(), "maps", "folders of textures such as albedo/neutral.png", "none", ""});
  }
  for (const std::string& name : wanted) {
    if (std::ranges::count(wanted, name) > 1) throw InputError({"--maps", "", "each map once", name + " twice", ""});
    if (found.contains(name)) continue;
    throw InputError({directory.string(), fmt::format("map \"{}\"", name),
                      fmt::format("one of {}", fmt::join(names, ", ")), "no such map", ""});
  }
  return wanted.empty() ? names : wanted;
}

/// The mesh of the neutral: as capture.json names it, else neutral.obj, its extension in any case.
fs::path neutralMesh(const fs::path& directory, const CaptureJson& description) {
  if (!description.neutral_mesh.empty()) return directory / description.neutral_mesh;
  for (const fs::path& file : geometry::objFiles(directory)) {
    if (file.stem() == "neutral") return file;
  }
  return directory / "neutral.obj";
}

std::optional<fs::path> optionalFile(const fs::path& directory, const std::string& named, const std::string& usual) {
  // What capture.json names, or stands there as a link that leads nowhere, is an error when it is read.
  if (!named.empty()) return directory / named;
  std::error_code error;
  if (fs::exists(fs::symlink_status(directory / usual, error))) return directory / usual;
  return std::nullopt;
}

/// The name of a capture that has none of its own.
std::string nameOf(const fs::path& directory) {
  const fs::path path = fs::absolute(directory).lexically_normal();  // "face/" ends in an empty name
  const std::string name = (path.has_filename() ? path : path.parent_path()).filename().string();
  if (!package::isUtf8(name)) {
    throw InputError({directory.string(), "name", "a name in UTF-8", package::quoted(name),
                      "rename the directory, or name the capture in capture.json"});
  }
  return name.empty() ? "capture" : name;
}

/// A misspelt name would leave the texture that its folder has in place.
void requireKnownExpressions(const std::string& map, const CaptureJson& description,
                             const std::vector<std::string>& expressions, const fs::path& directory) {
  const auto described = description.maps.find(map);
  if (described == description.maps.end()) return;
  for (const auto& [name, file] : described->second.expressions) {
    if (name == "neutral" || std::ranges::find(expressions, name) != expressions.end()) continue;
    throw InputError({(directory / kCaptureFile).string(), fmt::format("maps.{}.expressions", map),
                      "expressions of the capture", package::quoted(name), ""});
  }
}

}  // namespace

Capture openCapture(const fs::path& directory, const std::vector<std::string>& map_names, Progress* progress) {
  std::error_code error;
  if (!fs::is_directory(directory, error)) {
    throw InputError({directory.string(), "", "a capture directory",
                      fs::exists(directory, error) ? "a file" : "no such directory", ""});
  }
  const CaptureJson description = readCaptureJson(directory / kCaptureFile).value_or(CaptureJson{});
  const std::map<std::string, FoundMap> found = findMaps(directory, description);

  Capture capture;
  capture.directory = directory;
  capture.name = description.name.empty() ? nameOf(directory) : description.name;
  capture.unit = description.unit;
  capture.neutral_mesh = neutralMesh(directory, description);
  if (const std::string fault = faultOfFile(capture.neutral_mesh); !fault.empty()) {
    throw InputError({capture.neutral_mesh.string(), "", "the mesh of the neutral", fault, ""});
  }
  const std::vector<std::string> chosen = chooseMaps(directory, found, map_names);
  std::map<std::string, FoundMap> used;
  for (const std::string& name : chosen) {
    used[name] = found.at(name);
    requireName(name, "map", used[name].source);
    requireTextures(name, used[name]);
  }
  capture.expressions = expressionNames(directory, description, used);
  for (const std::string& name : chosen) requireKnownExpressions(name, description, capture.expressions, directory);
  for (const std::string& name : chosen) capture.maps.push_back(makeMap(name, used.at(name), capture.expressions));
  for (const auto& [name, file] : description.expression_meshes) {
    if (std::ranges::find(capture.expressions, name) != capture.expressions.end()) continue;
    throw InputError({(directory / kCaptureFile).string(), "expression_meshes", "expressions of the capture",
                      package::quoted(name), ""});
  }
  capture.expression_meshes =
      findExpressionMeshes(directory, description.expression_meshes, capture.expressions, progress);
  capture.face_region = optionalFile(directory, description.face_region, "face_region.txt");
  capture.coverage = optionalFile(directory, description.coverage, "coverage.png");
  capture.importance = optionalFile(directory, description.importance, "importance.png");
  return capture;
}

ProtectedPaths inputsOf(const Capture& capture) {
  const std::string what = "the capture that is read";
  ProtectedPaths inputs;
  inputs.add(capture.directory, what).addFile(capture.neutral_mesh, what);
  for (const auto& file : {capture.face_region, capture.coverage, capture.importance}) {
    inputs.addFile(file.value_or(fs::path()), what);
  }
  for (const fs::path& mesh : capture.expression_meshes) inputs.addFile(mesh, what);
  for (const CaptureMap& map : capture.maps) {
    inputs.addFile(map.neutral, what);
    for (const fs::path& texture : map.expressions) inputs.addFile(texture, what);
  }
  return inputs;
}

}  // namespace facezip
