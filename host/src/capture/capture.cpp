#include "facezip/capture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "capture/capture_json.hpp"
#include "capture/expression_meshes.hpp"
#include "capture/found_maps.hpp"
#include "capture/mesh_names.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "facezip/input_file.hpp"
#include "io/composed.hpp"
#include "io/quoted.hpp"
#include "io/safe_names.hpp"
#include "scene/morph_mesh.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

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
  const auto fault = io::nameFault(name, further);
  if (fault) throw InputError({file.string(), item, fault->expected, fault->got, "rename it"});
}

/// The expressions' names: capture.json's order, else every image name that any map has, sorted.
std::vector<std::string> expressionNames(const fs::path& directory, const CaptureJson& description,
                                         const std::map<std::string, FoundMap>& maps, NeutralAlone neutral_alone) {
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
  if (names.empty() && neutral_alone == NeutralAlone::kRefused) {
    throw InputError({directory.string(), "expressions", "at least one expression beside the neutral", "none",
                      "add MAP/NAME.png for every expression; `facezip rig` takes a neutral alone"});
  }
  return names;
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

/// The mesh of the neutral: as capture.json names it, else neutral.obj, its extension in any case, else with the meshes
/// of the expressions.
fs::path neutralMesh(const fs::path& directory, const CaptureJson& description) {
  if (!description.neutral_mesh.empty()) return directory / description.neutral_mesh;
  std::vector<fs::path> folders = {directory};
  if (!description.meshes.empty()) folders.push_back(directory / description.meshes);
  for (const fs::path& folder : folders) {
    std::map<std::string, fs::path> found;  // "neutral" goes last, and before what others call it
    for (const fs::path& file : geometry::objFiles(folder)) {
      const std::string name = io::composed(file.stem().string());
      if (description.neutral.empty() ? isNeutralMesh(name) : name == description.neutral) found.emplace(name, file);
    }
    if (!found.empty()) return found.rbegin()->second;
  }
  if (const fs::path file =
          scene::sceneFileIn(directory, fmt::format("name one as \"neutral_mesh\" in {}", kCaptureFile));
      !file.empty())
    return file;
  return directory / ((description.neutral.empty() ? "neutral" : description.neutral) + ".obj");
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
  const std::string name = io::composed((path.has_filename() ? path : path.parent_path()).filename().string());
  if (!io::isUtf8(name)) {
    throw InputError({directory.string(), "name", "a name in UTF-8", io::quoted(name),
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
                      "expressions of the capture", io::quoted(name), ""});
  }
}

}  // namespace

Capture openCapture(const fs::path& directory, const std::vector<std::string>& map_names, Progress* progress,
                    NeutralAlone neutral_alone) {
  std::error_code error;
  if (!fs::is_directory(directory, error)) {
    throw InputError({directory.string(), "", "a capture directory",
                      fs::exists(directory, error) ? "a file" : "no such directory", ""});
  }
  const CaptureJson description = readCaptureJson(directory / kCaptureFile).value_or(CaptureJson{});
  std::vector<std::string> wanted;
  for (const std::string& name : map_names) wanted.push_back(io::composed(name));
  const std::map<std::string, FoundMap> found = findMaps(directory, description, wanted, progress);

  Capture capture;
  capture.directory = directory;
  capture.name = description.name.empty() ? nameOf(directory) : description.name;
  capture.unit = description.unit;
  capture.neutral_mesh = neutralMesh(directory, description);
  capture.mesh_name = description.mesh;
  if (const std::string fault = faultOfFile(capture.neutral_mesh); !fault.empty()) {
    throw InputError({capture.neutral_mesh.string(), "", "the mesh of the neutral", fault, ""});
  }
  const std::vector<std::string> chosen = chooseMaps(directory, found, wanted);
  std::map<std::string, FoundMap> used;
  for (const std::string& name : chosen) {
    used[name] = found.at(name);
    requireName(name, "map", used[name].source);
  }
  capture.tile = chooseTile(directory, description.tile, used);
  requireTextures(used);
  capture.expressions = expressionNames(directory, description, used, neutral_alone);
  for (const std::string& name : chosen) requireKnownExpressions(name, description, capture.expressions, directory);
  for (const std::string& name : chosen) capture.maps.push_back(makeMap(name, used, capture.expressions));
  for (const auto& [name, file] : description.expression_meshes) {
    if (std::ranges::find(capture.expressions, name) != capture.expressions.end()) continue;
    throw InputError(
        {(directory / kCaptureFile).string(), "expression_meshes", "expressions of the capture", io::quoted(name), ""});
  }
  capture.expression_meshes = scene::isSceneFile(capture.neutral_mesh)
                                  ? findMorphTargets(capture, description, progress)
                                  : findExpressionMeshes(directory, description, capture.expressions, progress);
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
