#include "package/guides.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <set>
#include <utility>

#include "io/quoted.hpp"
#include "io/safe_names.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"

namespace facezip::package {
namespace {
using Document = nlohmann::ordered_json;

Document masksJson(const PackageMasks& masks) {
  return {{"file", masks.file},      {"count", masks.count},           {"columns", masks.columns},
          {"rows", masks.rows},      {"tile_width", masks.tile_width}, {"tile_height", masks.tile_height},
          {"samples", masks.samples}};
}

constexpr int kMostMasks = 1 << 16;
constexpr std::pair<PackageMaterial::Alpha, const char*> kAlphas[] = {{PackageMaterial::Alpha::kOpaque, "opaque"},
                                                                      {PackageMaterial::Alpha::kMask, "mask"},
                                                                      {PackageMaterial::Alpha::kBlend, "blend"}};

const char* alphaName(PackageMaterial::Alpha alpha) {
  return std::ranges::find(kAlphas, alpha, &std::pair<PackageMaterial::Alpha, const char*>::first)->second;
}

Document partsJson(const PackageParts& parts) {
  Document materials = Document::array();
  for (const PackageMaterial& material : parts.materials) materials.push_back(materialJson(material));
  return {{"file", parts.file}, {"materials", materials}};
}

PackageParts parseParts(const io::JsonField& field) {
  PackageParts parts;
  parts.file = io::fileInPackage(field["file"], ".glb");
  std::set<std::string> names;
  for (const io::JsonField& element : field["materials"].elements(1, kMostParts)) {
    parts.materials.push_back(parseMaterial(element));
    if (!names.insert(parts.materials.back().name).second) {
      element["name"].fail("unique names of materials", io::quoted(parts.materials.back().name) + " twice");
    }
  }
  return parts;
}

PackageMasks parseMasks(const io::JsonField& field) {
  PackageMasks masks;
  masks.file = io::fileInPackage(field["file"], ".png");
  masks.count = field["count"].integer(1, kMostMasks);
  masks.tile_width = field["tile_width"].integer(1, kMostMaskCells);
  masks.tile_height = field["tile_height"].integer(1, kMostMaskCells);
  masks.columns = field["columns"].integer(1, kMaxAtlasSide / masks.tile_width);
  masks.rows = field["rows"].integer(1, kMaxAtlasSide / masks.tile_height);
  if (masks.columns * masks.rows < masks.count) {
    field["rows"].fail(fmt::format("tiles for {} masks", masks.count),
                       fmt::format("{} x {} tiles", masks.columns, masks.rows));
  }
  const std::size_t count = static_cast<std::size_t>(masks.count);
  for (const io::JsonField& sample : field["samples"].elements(count, count)) {
    const std::vector<io::JsonField> uv = sample.elements(2, 2);
    constexpr double kRoom = 1e-3;  // UVs of exporters pass 0 and 1 by their rounding
    masks.samples.push_back({uv[0].number(-kRoom, 1.0 + kRoom), uv[1].number(-kRoom, 1.0 + kRoom)});
  }
  return masks;
}

std::vector<PackageRegion> parseRegions(const io::JsonField& field, int mask_count) {
  std::vector<PackageRegion> regions;
  std::set<std::string> names;
  std::set<int> taken;
  for (const io::JsonField& element : field.elements(0, kMostMasks)) {
    PackageRegion& region = regions.emplace_back();
    region.name = io::fileSafeName(element["name"]);
    if (!names.insert(region.name).second)
      element["name"].fail("unique region names", io::quoted(region.name) + " twice");
    for (const io::JsonField& mask : element["masks"].elements(0, static_cast<std::size_t>(mask_count))) {
      region.masks.push_back(mask.integer(0, mask_count - 1));
      if (!taken.insert(region.masks.back()).second) mask.fail("a mask that no other region has", mask.got());
    }
  }
  return regions;
}

/// The header of glTF's binary form names its own length: a file that was cut does not keep the promise.
std::uint64_t checkMesh(const io::Folder& folder, const std::string& name) {
  const InputFile file = folder.open(name, "the mesh of the package", "write the package again");
  std::array<std::uint32_t, 3> header = {};
  const bool whole = ::pread(file.descriptor(), header.data(), sizeof(header), 0) == sizeof(header);
  if (!whole || std::memcmp(header.data(), "glTF", 4) != 0 || header[1] != 2 || header[2] != file.size()) {
    throw InputError({(folder.path() / name).string(), "", "a whole binary glTF 2.0 file",
                      fmt::format("{} bytes that are none", file.size()),
                      "the file is truncated or damaged: write the package again"});
  }
  return file.size();
}

}  // namespace

void addGuides(const PackageDescription& description, Document& document) {
  if (!description.mesh_file.empty()) document["mesh"] = {{"file", description.mesh_file}};
  if (description.parts) document["parts"] = partsJson(*description.parts);
  if (description.masks) document["masks"] = masksJson(*description.masks);
  if (description.regions.empty()) return;
  Document regions = Document::array();
  for (const PackageRegion& region : description.regions) {
    regions.push_back({{"name", region.name}, {"masks", region.masks}});
  }
  document["regions"] = regions;
}

void parseGuides(const io::JsonField& document, PackageDescription& description) {
  if (document.has("mesh")) description.mesh_file = io::fileInPackage(document["mesh"]["file"], ".glb");
  if (document.has("parts")) {
    if (description.mesh_file.empty()) document["parts"].fail("a mesh whose parts these are", "no field mesh");
    description.parts = parseParts(document["parts"]);
  }
  if (document.has("masks")) description.masks = parseMasks(document["masks"]);
  if (!document.has("regions")) return;
  if (!description.masks) document["regions"].fail("masks that regions are made of", "no field masks");
  description.regions = parseRegions(document["regions"], description.masks->count);
}

image::ImageShape masksShape(const PackageMasks& masks) {
  return {masks.columns * masks.tile_width, masks.rows * masks.tile_height, 1, image::SampleType::kUint8};
}

image::ImageShape textureShape(const PackageMaterial& material) {
  return {material.width, material.height, material.channels, image::SampleType::kUint8};
}

Document materialJson(const PackageMaterial& material) {
  Document json = {{"name", material.name},
                   {"colour", material.colour},
                   {"opacity", material.opacity},
                   {"alpha", alphaName(material.alpha)},
                   {"roughness", material.roughness}};
  if (material.texture.empty()) return json;
  json["texture"] = {{"file", material.texture},
                     {"width", material.width},
                     {"height", material.height},
                     {"channels", material.channels}};
  return json;
}

PackageMaterial parseMaterial(const io::JsonField& field) {
  PackageMaterial material;
  material.name = io::fileSafeName(field["name"]);
  const std::vector<io::JsonField> colour = field["colour"].elements(3, 3);
  for (std::size_t c = 0; c < 3; ++c) material.colour[c] = colour[c].number(0, 1);
  material.opacity = field["opacity"].number(0, 1);
  const std::string alpha = field["alpha"].text();
  const auto found = std::ranges::find(kAlphas, alpha, &std::pair<PackageMaterial::Alpha, const char*>::second);
  if (found == std::end(kAlphas)) field["alpha"].fail(R"("opaque", "mask" or "blend")", field["alpha"].got());
  material.alpha = found->first;
  material.roughness = field["roughness"].number(0, 1);
  if (!field.has("texture")) return material;
  const io::JsonField texture = field["texture"];
  material.texture = io::fileInPackage(texture["file"], ".png");
  material.width = texture["width"].integer(1, kMaxAtlasSide);
  material.height = texture["height"].integer(1, kMaxAtlasSide);
  material.channels = texture["channels"].integer(1, 4);
  return material;
}

std::uint64_t checkGuides(const PackageDescription& description, const io::Folder& folder) {
  std::uint64_t bytes = 0;
  if (!description.mesh_file.empty()) bytes += checkMesh(folder, description.mesh_file);
  if (description.parts) {
    bytes += checkMesh(folder, description.parts->file);
    for (const PackageMaterial& material : description.parts->materials) {
      if (!material.texture.empty()) bytes += checkImage(folder, material.texture, textureShape(material));
    }
  }
  if (description.masks) bytes += checkImage(folder, description.masks->file, masksShape(*description.masks));
  return bytes;
}

}  // namespace facezip::package
