#include "facezip/export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "export/engine_maps.hpp"
#include "export/export_files.hpp"
#include "export/gltf_scene.hpp"
#include "export/godot.hpp"
#include "export/unity.hpp"
#include "export/unreal.hpp"
#include "facezip/check.hpp"
#include "facezip/view.hpp"
#include "io/file_pieces.hpp"
#include "io/folder.hpp"
#include "io/staged_directory.hpp"
#include "package/package_json.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

/// Textures that the material of scene.gltf refers to.
enum class Textures {
  kPackage,  ///< the package's copy, with the blend as extras
  kOwn,      ///< those that engines get
  kNone      ///< the target has a material of its own
};

/// What a target gets beside scene.gltf: names of embedded files, the first its README, and what `write` makes of the
/// package; without it, a copy.
struct Target {
  std::vector<std::string> files;
  Textures textures = Textures::kPackage;
  void (*write)(const Package& package, const fs::path& folder, Progress& progress) = nullptr;
};

const std::map<std::string, Target>& targets() {
  static const std::map<std::string, Target> all = {
      {"gltf", {{"gltf.md", "facezip_blend.h"}}},
      {"three", {{"three.md", "facezip_three.js"}}},
      {"blender", {{"blender.md", "facezip_blender.py"}}},
      {"godot", {{"godot.md", "facezip_face.gd", "demo.gd"}, Textures::kNone, exporting::writeGodot}},
      {"unity", {{"unity.md", "FaceZipDriver.cs", "FaceZipImport.cs"}, Textures::kOwn, exporting::writeUnity}},
      {"unreal", {{"unreal.md", "facezip_unreal.py"}, Textures::kNone, exporting::writeUnreal}}};
  return all;
}

void copyFile(const Package& package, const std::string& name, const fs::path& to) {
  const InputFile file = package.folder().open(name, "a file of the package");
  std::ofstream out(to, std::ios::binary);
  io::forEachPiece(file, (package.directory() / name).string(), std::size_t{1} << 20,
                   [&](std::string_view piece) { out << piece; });
  out.close();
  if (!out) throw OutputError(to, "could not be written", "is the disk full?");
}

void copyPackage(const Package& package, const fs::path& folder, std::uint64_t memory_bytes, Progress& progress) {
  checkTexels(package, progress, memory_bytes);
  for (const std::string& name : packageFiles(package)) {
    progress.checkCancelled();
    const fs::path to = folder / name;
    io::createDirectories(to.parent_path());
    copyFile(package, name, to);
  }
}

/// The blend for readers of glTF: package.json as it is but for how it was made, which is unstable.
nlohmann::json blendExtras(const PackageDescription& description) {
  nlohmann::json blend = nlohmann::json::parse(package::packageJson(description));
  blend.erase("method");
  blend["folder"] = "package";
  return {{"facezip", blend}};
}

/// The material of scene.gltf, for tools that know nothing of facezip: plain neutrals.
exporting::GltfMaterial plainMaterial(const Package& package, Textures textures) {
  exporting::GltfMaterial material;
  if (textures == Textures::kNone) return material;
  const bool own = textures == Textures::kOwn;
  for (const exporting::EngineMap& map : exporting::engineMaps(package)) {
    if (!own && !map.map.neutral_file.ends_with(".png")) continue;
    const std::string file = own ? "textures/" + map.id + "_neutral.png" : "package/" + map.map.neutral_file;
    if (map.role == exporting::MapRole::kAlbedo) material.base_colour_texture = file;
    if (map.role == exporting::MapRole::kNormal) material.normal_texture = file;
  }
  if (!own) material.extras = blendExtras(package.description());
  return material;
}

}  // namespace

std::vector<std::string> exportTargets() {
  std::vector<std::string> names;
  for (const auto& [name, made] : targets()) names.push_back(name);
  return names;
}

std::vector<std::string> exportPackage(const Package& package, const std::string& target, const fs::path& output,
                                       Progress& progress, std::uint64_t memory_bytes) {
  const auto found = targets().find(target);
  if (found == targets().end()) {
    throw InputError({"--target", "", fmt::format("{}", fmt::join(exportTargets(), ", ")), target, ""});
  }
  const PackageDescription& description = package.description();
  if (description.mesh_file.empty()) {
    throw InputError({package.directory().string(), "mesh", "a package with meshes", "none",
                      "compress the capture again, without --no-mesh"});
  }
  inputsOf(package).requireApartFromFolder(output);
  io::StagedDirectory staged(output, {"scene.gltf", "\"generator\": \"facezip "}, &progress);
  const Target& chosen = found->second;
  if (chosen.write != nullptr) {
    chosen.write(package, staged.path(), progress);
  } else {
    copyPackage(package, staged.path() / "package", memory_bytes, progress);
  }
  exporting::addBlendToGltf(mesh::readPackageMesh(package, memory_bytes), staged.path() / "scene.gltf",
                            plainMaterial(package, chosen.textures));
  for (const std::string& file : chosen.files) {
    const std::string name = file.ends_with(".md") ? "README.md" : file;
    io::writeTextFile(staged.path() / name, std::string(exporting::embeddedExportFiles().at(file)));
  }
  staged.commit();
  return chosen.write != nullptr ? exporting::lossesOf(package) : std::vector<std::string>();
}

}  // namespace facezip
