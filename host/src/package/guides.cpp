#include "package/guides.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <set>

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
  if (document.has("masks")) description.masks = parseMasks(document["masks"]);
  if (!document.has("regions")) return;
  if (!description.masks) document["regions"].fail("masks that regions are made of", "no field masks");
  description.regions = parseRegions(document["regions"], description.masks->count);
}

image::ImageShape masksShape(const PackageMasks& masks) {
  return {masks.columns * masks.tile_width, masks.rows * masks.tile_height, 1, image::SampleType::kUint8};
}

std::uint64_t checkGuides(const PackageDescription& description, const io::Folder& folder) {
  std::uint64_t bytes = 0;
  if (!description.mesh_file.empty()) bytes += checkMesh(folder, description.mesh_file);
  if (description.masks) bytes += checkImage(folder, description.masks->file, masksShape(*description.masks));
  return bytes;
}

}  // namespace facezip::package
