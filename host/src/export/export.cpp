#include "facezip/export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "convert/converted_files.hpp"
#include "export/engine_maps.hpp"
#include "export/export_files.hpp"
#include "export/godot.hpp"
#include "export/unity.hpp"
#include "export/unreal.hpp"
#include "facezip/check.hpp"
#include "facezip/view.hpp"
#include "io/staged_directory.hpp"
#include "mesh/gltf_scene.hpp"
#include "package/file_copy.hpp"
#include "package/package_json.hpp"
#include "package/package_textures.hpp"

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
  std::vector<mesh::MapRole> roles;  ///< that its material shows
  Textures textures = Textures::kPackage;
  void (*write)(const Package& package, const fs::path& folder, Progress& progress) = nullptr;
  exporting::KeptBlocks kept = exporting::noBlocks;
  std::string recoded = "";  ///< what becomes of images of blocks, for a note
  bool reads_blocks = true;  ///< of a copy of the package; else it becomes one of images
};

const std::map<std::string, Target>& targets() {
  static const std::vector<mesh::MapRole> every = {mesh::MapRole::kAlbedo, mesh::MapRole::kNormal,
                                                   mesh::MapRole::kRoughness, mesh::MapRole::kOcclusion};
  // Cycles finds occlusion itself.
  static const std::vector<mesh::MapRole> traced = {mesh::MapRole::kAlbedo, mesh::MapRole::kNormal,
                                                    mesh::MapRole::kRoughness};
  static const std::map<std::string, Target> all = {
      {"gltf", {{"gltf.md", "facezip_blend.h"}, every}},
      {"three", {{"three.md", "facezip_three.js"}, every}},
      {"blender",
       {{"blender.md", "facezip_blender.py"},
        traced,
        Textures::kPackage,
        nullptr,
        exporting::noBlocks,
        "which Blender reads",
        false}},
      {"godot",
       {{"godot.md", "facezip_face.gd", "demo.gd"},
        every,
        Textures::kNone,
        exporting::writeGodot,
        exporting::noBlocks,
        "which Godot 3 keeps uncompressed"}},
      {"unity",
       {{"unity.md", "FaceZipDriver.cs", "FaceZipImport.cs"},
        every,
        Textures::kOwn,
        exporting::writeUnity,
        exporting::unityBlocks,
        "which Unity keeps uncompressed: of ASTC it takes square blocks, of BC sides that are "
        "multiples of 4"}},
      {"unreal",
       {{"unreal.md", "facezip_unreal.py"},
        every,
        Textures::kNone,
        exporting::writeUnreal,
        exporting::noBlocks,
        "which Unreal codes again, as the script says it"}}};
  return all;
}

bool hasBlocks(const Package& package) { return std::ranges::any_of(package.maps(), package::hasBlocks); }

void copyPackage(const Package& package, const Target& target, const fs::path& folder, std::uint64_t memory_bytes,
                 Progress& progress) {
  checkTexels(package, progress, memory_bytes);
  if (!target.reads_blocks && hasBlocks(package)) {
    io::createDirectories(folder);
    return convert::writeAsImages(package, folder, progress);
  }
  for (const std::string& name : packageFiles(package)) {
    progress.checkCancelled();
    const fs::path to = folder / name;
    io::createDirectories(to.parent_path());
    package::copyFile(package, name, to);
  }
}

/// The blend for readers of glTF: package.json as it is but for how it was made, which is unstable, and which map is
/// what in a material.
nlohmann::json blendExtras(const PackageDescription& description) {
  nlohmann::json blend = nlohmann::json::parse(package::packageJson(description));
  blend.erase("method");
  blend["folder"] = "package";
  blend["roles"] = nlohmann::json::object();
  const std::vector<mesh::MapRole> roles = mesh::rolesOf(description.maps);
  for (std::size_t m = 0; m < roles.size(); ++m) {
    if (roles[m] != mesh::MapRole::kOther) blend["roles"][mesh::roleName(roles[m])] = description.maps[m].name;
  }
  return {{"facezip", blend}};
}

/// The material of scene.gltf, for tools that know nothing of facezip: plain neutrals. Of one in blocks, which glTF
/// does not know, an image is written.
mesh::GltfMaterial plainMaterial(const Package& package, const Target& target, const fs::path& folder,
                                 Progress& progress) {
  mesh::GltfMaterial material;
  if (target.textures == Textures::kNone) return material;
  const bool own = target.textures == Textures::kOwn;
  for (const exporting::EngineMap& map : exporting::engineMaps(package)) {
    if (own && target.kept(map.map, -1)) continue;  // the engine's material has it
    std::string file = own ? "textures/" + map.id + "_neutral.png" : "package/" + map.map.neutral_file;
    if (!own && map.map.neutral_format) {
      if (map.role == mesh::MapRole::kOther) continue;
      file = "textures/" + map.id + "_neutral.png";
      io::createDirectories(folder / "textures");
      exporting::writeNeutral(package, map, folder / "textures", progress);
    }
    if (map.role == mesh::MapRole::kAlbedo) material.base_colour_texture = file;
    if (map.role == mesh::MapRole::kNormal) material.normal_texture = file;
    if (map.role == mesh::MapRole::kRoughness) material.roughness_texture = file;
    if (map.role == mesh::MapRole::kOcclusion) material.occlusion_texture = file;
  }
  if (!own) material.extras = blendExtras(package.description());
  return material;
}

/// scene.gltf, whose material speaks of the package that lies beside it, and, where the target has no copy of the
/// package, the textures of its parts.
void writeScene(const Package& package, const Target& target, const fs::path& folder, std::uint64_t memory_bytes,
                Progress& progress) {
  const mesh::PackageMesh mesh = mesh::readPackageMesh(package, memory_bytes);
  const bool made_images = target.write == nullptr && !target.reads_blocks && hasBlocks(package);
  const mesh::GltfMaterial material =
      plainMaterial(made_images ? Package::open(folder / "package") : package, target, folder, progress);
  const std::optional<PackageParts>& described = package.description().parts;
  if (!described) return mesh::addBlendToGltf(mesh, nullptr, folder / "scene.gltf", material);
  mesh::GltfParts parts{mesh::readPackageParts(package, mesh, memory_bytes), described->materials};
  for (std::size_t p = 0; p < parts.materials.size(); ++p) {
    std::string& texture = parts.materials[p].texture;
    if (texture.empty()) continue;
    if (target.textures == Textures::kPackage) {
      texture = "package/" + texture;
      continue;
    }
    const std::string name = fmt::format("parts/part_{}.png", p);  // engines are not all content with any name
    io::createDirectories(folder / "parts");
    package::copyFile(package, texture, folder / name);
    texture = name;
  }
  mesh::addBlendToGltf(mesh, &parts, folder / "scene.gltf", material);
}

/// A name that shells and languages take as it stands.
bool isPlain(const std::string& name) {
  const auto letter = [](char c) { return c == '_' || ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z'); };
  const auto digit = [](char c) { return '0' <= c && c <= '9'; };
  return letter(name.front()) && std::ranges::all_of(name, [&](char c) { return letter(c) || digit(c); });
}

/// A README whose examples have names of the package, so that they run as they stand.
std::string withNames(std::string text, const Package& package) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const std::string& name : package.expressions()) {
    if (isPlain(name)) names.emplace_back(fmt::format("@EXPRESSION_{}@", names.size() + 1), name);
    if (names.size() == 2) break;
  }
  const auto map = std::ranges::find_if(
      package.maps(), [](const PackageMap& m) { return isPlain(m.name) && m.sample_type != SampleType::kFloat32; });
  if (map != package.maps().end()) names.emplace_back("@MAP@", map->name);
  for (const char* left : {"@EXPRESSION_1@", "@EXPRESSION_2@", "@MAP@"}) names.emplace_back(left, "NAME");
  for (const auto& [placeholder, name] : names) {
    for (std::size_t at = text.find(placeholder); at != std::string::npos; at = text.find(placeholder)) {
      text.replace(at, placeholder.size(), name);
    }
  }
  return text;
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
  if (package.description().mesh_file.empty()) {
    throw InputError({package.directory().string(), "mesh", "a package with meshes", "none",
                      "compress the capture again, without --no-mesh"});
  }
  inputsOf(package).requireApartFromFolder(output);
  io::StagedDirectory staged(output, {"scene.gltf", "\"generator\": \"facezip "}, &progress);
  const Target& chosen = found->second;
  if (chosen.write != nullptr) {
    chosen.write(package, staged.path(), progress);
  } else {
    copyPackage(package, chosen, staged.path() / "package", memory_bytes, progress);
  }
  writeScene(package, chosen, staged.path(), memory_bytes, progress);
  for (const std::string& file : chosen.files) {
    const std::string text(exporting::embeddedExportFiles().at(file));
    const bool readme = file.ends_with(".md");
    io::writeTextFile(staged.path() / (readme ? "README.md" : file), readme ? withNames(text, package) : text);
  }
  staged.commit();
  std::vector<std::string> notes;
  if (chosen.write != nullptr || !chosen.reads_blocks) {
    notes = exporting::lossesOf(package, chosen.kept, chosen.recoded);
  }
  for (std::string& note : mesh::notesOfRoles(package.maps(), chosen.roles)) notes.push_back(std::move(note));
  return notes;
}

}  // namespace facezip
