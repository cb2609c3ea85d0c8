#include "convert/converted_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "bands/map_bands.hpp"
#include "compress/package_output.hpp"
#include "facezip/rig.hpp"
#include "io/json_field.hpp"
#include "io/write_file.hpp"
#include "package/file_copy.hpp"
#include "package/guides.hpp"
#include "package/package_files.hpp"
#include "package/package_textures.hpp"
#include "package/package_writer.hpp"
#include "rig/rig_json.hpp"

namespace facezip::convert {
namespace fs = std::filesystem;
namespace {
using compress::BlockTextures;
using nlohmann::json;
using package::copyFile;

constexpr int kRowsAtOnce = 64;

/// How the package was made, with the formats it has now: `evaluate` makes its baselines by it.
std::string methodOf(const PackageDescription& description) {
  json record = json::parse(description.method_json);
  record.erase("texture_format");
  record.erase("difference_format");
  for (const PackageMap& map : description.maps) {
    if (!map.neutral_format || record.contains("texture_format")) continue;
    record["texture_format"] = blockFormatName(*map.neutral_format);
    record["difference_format"] = blockFormatName(*map.differences.front().format);
  }
  return record.dump();
}

void describeBlocks(const ConvertedSet& set, std::size_t i, PackageMap& map) {
  map.neutral_format = set.neutrals[i].format;
  map.difference_bits = 8;
  const auto channels = toSize(map.channels);
  for (std::size_t d = 0; d < map.differences.size(); ++d) {
    PackageDifference& difference = map.differences[d];
    difference.format = set.codes[i].formats[d];
    for (std::size_t c = 0; c < channels; ++c) {
      const compress::TextureEncoding& e = set.codes[i].encoding[d * channels + c];
      difference.scale[c] = e.scale;
      difference.offset[c] = e.offset;
    }
  }
}

void describeImages(PackageMap& map) {
  map.neutral_format.reset();
  for (PackageDifference& difference : map.differences) difference.format.reset();
}

PackageDescription describe(const Package& package, std::span<const std::unique_ptr<ConvertedSet>> sets) {
  PackageDescription description = package.description();
  if (!description.mesh_file.empty()) description.mesh_file = package::kMeshFile;
  if (description.masks) description.masks->file = package::kMasksFile;
  if (description.parts) description.parts->file = package::kPartsFile;
  if (sets.empty()) {
    for (PackageMap& map : description.maps) describeImages(map);
  }
  for (std::size_t s = 0; s < sets.size(); ++s) {
    description.weights[s].scale = sets[s]->weights.scale;
    description.weights[s].offset = sets[s]->weights.offset;
    for (std::size_t i = 0; i < sets[s]->indices.size(); ++i) {
      describeBlocks(*sets[s], i, description.maps[toSize(sets[s]->indices[i])]);
    }
  }
  description.method_json = methodOf(description);
  return description;
}

/// Samples of 16 bits as the nearest of 8.
std::vector<std::byte> wholeCodes(std::span<const std::byte> wide) {
  std::vector<std::byte> codes(wide.size() / 2);
  for (std::size_t s = 0; s < codes.size(); ++s) {
    std::uint16_t sample = 0;
    std::memcpy(&sample, &wide[2 * s], sizeof(sample));
    codes[s] = static_cast<std::byte>((sample + 128u) / 257u);
  }
  return codes;
}

/// A texture as the image that it is, or that its blocks decode to.
template <typename Write>
void copyTexture(const Package& package, const package::StoredTexture& texture, const Write& write) {
  package::TextureReader reader(package.folder(), texture);
  const image::ImageShape& shape = reader.shape();
  const bool rounds = texture.format && shape.type == SampleType::kUint16;
  std::vector<std::byte> rows;
  for (int begin = 0; begin < shape.height; begin += kRowsAtOnce) {
    const int end = std::min(begin + kRowsAtOnce, shape.height);
    rows.resize(toSize(end - begin) * shape.rowBytes());
    reader.readRows(begin, end, rows);
    if (rounds) {
      write(wholeCodes(rows), end - begin);
    } else {
      write(rows, end - begin);
    }
  }
}

void writeImages(const Package& package, int index, package::PackageWriter& writer, Progress& progress) {
  const PackageMap& map = package.maps()[toSize(index)];
  progress.checkCancelled();
  copyTexture(package, package::neutralTexture(map),
              [&](std::span<const std::byte> rows, int count) { writer.writeNeutralRows(index, rows, count); });
  for (int i = 0; i < package.differences(); ++i) {
    progress.checkCancelled();
    copyTexture(package, package::differenceTexture(map, i),
                [&](std::span<const std::byte> rows, int count) { writer.writeDifferenceRows(index, i, rows, count); });
  }
}

void writeBlocks(const ConvertedSet& set, std::size_t i, const PackageMap& described, const fs::path& directory,
                 const device::Run& run) {
  compress::MapSolution solution;
  solution.map = set.group[i];
  solution.codes = set.codes[i];
  solution.neutral = &set.neutrals[i];
  solution.block_textures =
      std::make_unique<BlockTextures>(run.context, set.space, set.weights, solution.codes, described.channels);
  compress::BandBuffers buffers(run.context);
  compress::writeBlockMap(solution, described, directory, set.band_rows, buffers, run);
}

/// rig.gltf shows neutrals that may be no images any more, since glTF knows no blocks. Of its textures those of parts
/// stay. parts  names of their images. Throws InputError.
std::string withoutNeutrals(const std::string& text, const std::string& file, const std::set<std::string>& parts) {
  json scene = io::parseJson(text, file);
  json images = json::array(), textures = json::array();
  const auto keepPart = [&](json& holder, const char* field) {
    if (!holder.contains(field)) return;
    json texture = scene.at("textures").at(holder.at(field).at("index").get<std::size_t>());
    const json& image = scene.at("images").at(texture.at("source").get<std::size_t>());
    if (!parts.contains(image.at("uri").get<std::string>())) {
      holder.erase(field);
      return;
    }
    texture["source"] = images.size();
    images.push_back(image);
    holder[field]["index"] = textures.size();
    textures.push_back(texture);
  };
  try {
    json materials = scene.value("materials", json::array());
    for (json& material : materials) {
      keepPart(material, "normalTexture");
      if (material.contains("pbrMetallicRoughness")) keepPart(material["pbrMetallicRoughness"], "baseColorTexture");
    }
    scene["materials"] = materials;
  } catch (const json::exception& error) {
    throw InputError({file, "materials", "those that `facezip rig` wrote", error.what(), "make the rig again"});
  }
  const auto replace = [&scene](const char* key, const json& values) {
    if (values.empty()) {
      scene.erase(key);
    } else {
      scene[key] = values;
    }
  };
  replace("images", images);
  replace("textures", textures);
  if (textures.empty()) scene.erase("samplers");
  return scene.dump();
}

/// Images of the parts' materials, by their names in the package.
std::set<std::string> partTextures(const Package& package) {
  std::set<std::string> names;
  const std::optional<PackageParts>& parts = package.description().parts;
  if (!parts) return names;
  for (const PackageMaterial& material : parts->materials) {
    if (!material.texture.empty()) names.insert(material.texture);
  }
  return names;
}

void copyRig(const Package& package, bool keeps_images, const fs::path& directory, Progress& progress) {
  if (!isRig(package)) return;
  const Rig rig = openRig(package);
  copyFile(package, rig::kRigFile, directory / rig::kRigFile);
  copyFile(package, "rig.bin", directory / "rig.bin");
  if (keeps_images) {
    copyFile(package, "rig.gltf", directory / "rig.gltf");
  } else {
    const InputFile file = package.folder().open("rig.gltf", "the rig's scene");
    const std::string path = (package.directory() / "rig.gltf").string();
    io::writeTextFile(directory / "rig.gltf",
                      withoutNeutrals(file.read(rig::kMostRigBytes), path, partTextures(package)));
  }
  io::createDirectories(directory / "shapes");
  copyFile(package, "shapes/neutral.obj", directory / "shapes/neutral.obj");
  for (const std::string& shape : rig.shapes) {
    progress.checkCancelled();
    copyFile(package, "shapes/" + shape + ".obj", directory / ("shapes/" + shape + ".obj"));
  }
}

/// What does not depend on the form of textures.
void copyBeside(const Package& package, const PackageDescription& description, const fs::path& directory) {
  if (!description.mesh_file.empty()) {
    copyFile(package, package.description().mesh_file, directory / description.mesh_file);
  }
  if (description.masks) copyFile(package, package.description().masks->file, directory / description.masks->file);
  if (!description.parts) return;
  copyFile(package, package.description().parts->file, directory / description.parts->file);
  for (const std::string& texture : partTextures(package)) {
    io::createDirectories((directory / texture).parent_path());
    copyFile(package, texture, directory / texture);
  }
}

}  // namespace

void writeAsImages(const Package& package, const fs::path& directory, Progress& progress) {
  package::PackageWriter writer(describe(package, {}), directory);
  progress.stage("writing", 0);
  for (int set = 0; set < static_cast<int>(package.weightSets().size()); ++set) {
    const compress::EncodedWeights weights = readWeights(package, set);
    writer.writeWeights(set, std::as_bytes(std::span(weights.codes)));
  }
  for (std::size_t m = 0; m < package.maps().size(); ++m) {
    writeImages(package, static_cast<int>(m), writer, progress);
  }
  copyBeside(package, writer.description(), directory);
  copyRig(package, true, directory, progress);
  writer.finish();
}

void writeConverted(const Package& package, std::span<const std::unique_ptr<ConvertedSet>> sets,
                    const fs::path& directory, const device::Run& run) {
  package::PackageWriter writer(describe(package, sets), directory);
  const PackageDescription& description = writer.description();
  run.progress.stage("writing", 0);
  for (std::size_t set = 0; set < sets.size(); ++set) {
    writer.writeWeights(static_cast<int>(set), std::as_bytes(std::span(sets[set]->weights.codes)));
  }
  for (std::size_t m = 0; m < description.maps.size(); ++m) {
    if (!description.maps[m].neutral_format) writeImages(package, static_cast<int>(m), writer, run.progress);
  }
  for (const auto& set : sets) {
    for (std::size_t i = 0; i < set->indices.size(); ++i) {
      writeBlocks(*set, i, description.maps[toSize(set->indices[i])], directory, run);
    }
  }
  copyBeside(package, description, directory);
  copyRig(package, false, directory, run.progress);
  writer.finish();
}

}  // namespace facezip::convert
