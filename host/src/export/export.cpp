#include "facezip/export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>

#include "export/export_files.hpp"
#include "export/gltf_scene.hpp"
#include "facezip/view.hpp"
#include "io/staged_directory.hpp"
#include "package/package_json.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

/// What a target gets beside scene.gltf and the package: names of embedded files. The first is its README.
const std::map<std::string, std::vector<std::string>>& targets() {
  static const std::map<std::string, std::vector<std::string>> files = {
      {"gltf", {"gltf.md", "facezip_blend.h"}},
      {"three", {"three.md", "facezip_three.js"}},
      {"blender", {"blender.md", "facezip_blender.py"}}};
  return files;
}

void copyPackage(const Package& package, const fs::path& folder) {
  for (const std::string& name : packageFiles(package)) {
    const fs::path to = folder / name;
    io::createDirectories(to.parent_path());
    std::error_code error;
    fs::copy_file(package.directory() / name, to, error);
    if (error) throw OutputError(to, error.message());
  }
}

/// The blend for readers of glTF: package.json as it is but for how it was made, which is unstable.
nlohmann::json blendExtras(const PackageDescription& description) {
  nlohmann::json blend = nlohmann::json::parse(package::packageJson(description));
  blend.erase("method");
  blend["folder"] = "package";
  return {{"facezip", blend}};
}

/// Path of a neutral that glTF takes as texture: PNG, of a map with `part` in its name; "" if there is none.
std::string neutralTexture(const Package& package, std::string_view part) {
  for (const PackageMap& map : package.maps()) {
    std::string name = map.name;
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (name.find(part) == std::string::npos || !map.neutral_file.ends_with(".png")) continue;
    return "package/" + map.neutral_file;
  }
  return "";
}

}  // namespace

std::vector<std::string> exportTargets() {
  std::vector<std::string> names;
  for (const auto& [name, files] : targets()) names.push_back(name);
  return names;
}

void exportPackage(const Package& package, const std::string& target, const fs::path& output) {
  const auto files = targets().find(target);
  if (files == targets().end()) {
    throw InputError({"--target", "", fmt::format("{}", fmt::join(exportTargets(), ", ")), target, ""});
  }
  const PackageDescription& description = package.description();
  if (description.mesh_file.empty()) {
    throw InputError({package.directory().string(), "mesh", "a package with meshes", "none",
                      "compress the capture again, without --no-mesh"});
  }
  io::StagedDirectory staged(output, io::StagedDirectory::Existing::kReplaceMarked, "scene.gltf");
  copyPackage(package, staged.path() / "package");
  exporting::addBlendToGltf(
      package.directory() / description.mesh_file, staged.path() / "scene.gltf",
      {neutralTexture(package, "albedo"), neutralTexture(package, "normal"), blendExtras(description)});
  for (const std::string& file : files->second) {
    const std::string name = file.ends_with(".md") ? "README.md" : file;
    io::writeTextFile(staged.path() / name, std::string(exporting::embeddedExportFiles().at(file)));
  }
  staged.commit();
}

}  // namespace facezip
