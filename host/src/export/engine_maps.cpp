#include "export/engine_maps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>

#include "export/texture_copy.hpp"
#include "package/file_copy.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"
#include "package/weight_atlas.hpp"

namespace facezip::exporting {
namespace fs = std::filesystem;
namespace {

std::string lowerCase(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Letters, digits and single underscores, a letter first: what GLSL, HLSL and C# take. Unique on file systems that
/// ignore case too, and never like the files of weights.
std::string identifier(const std::string& name, const std::set<std::string>& taken) {
  std::string id;
  for (const char c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 128;
    if (plain) id += c;
    if (!plain && !id.empty() && id.back() != '_') id += '_';
  }
  while (!id.empty() && id.back() == '_') id.pop_back();
  if (id.empty()) id = "map";
  if (std::isalpha(static_cast<unsigned char>(id[0])) == 0 || lowerCase(id).starts_with("weights")) id = "map_" + id;
  std::string unique = id;
  for (int i = 2; taken.contains(lowerCase(unique)); ++i) unique = fmt::format("{}_{}", id, i);
  return unique;
}

/// Codes of 16 bits are exported as the nearest of 8, zero as the nearest too: nothing then stays nothing.
EngineDifference engineDifference(const PackageMap& map, const PackageDifference& difference) {
  const double step = map.difference_bits == 16 ? 257.0 : 1.0;
  EngineDifference engine;
  for (std::size_t c = 0; c < difference.scale.size(); ++c) {
    const double scale = difference.scale[c];
    if (scale == 0.0) continue;
    engine.zero[c] = std::round(-difference.offset[c] / scale / step) / 255.0;
    engine.scale[c] = scale * step;  // times 255 codes, over 255 for units of full scale
  }
  return engine;
}

std::vector<package::StoredTexture> differencesOf(const EngineMap& map) {
  std::vector<package::StoredTexture> textures;
  for (int i = 0; i < static_cast<int>(map.map.differences.size()); ++i) {
    textures.push_back(package::differenceTexture(map.map, i));
  }
  return textures;
}

/// The format of a texture that is stored in blocks and written as an image; none where there is no such.
std::optional<BlockFormat> decodedBlocks(const PackageMap& map, KeptBlocks kept) {
  if (map.neutral_format && !kept(map, -1)) return map.neutral_format;
  for (std::size_t i = 0; i < map.differences.size(); ++i) {
    if (map.differences[i].format && !kept(map, static_cast<int>(i))) return map.differences[i].format;
  }
  return std::nullopt;
}

}  // namespace

std::vector<EngineMap> engineMaps(const Package& package) {
  std::vector<EngineMap> maps;
  std::set<std::string> taken;
  const std::vector<mesh::MapRole> roles = mesh::rolesOf(package.maps());
  for (std::size_t m = 0; m < roles.size(); ++m) {
    const PackageMap& map = package.maps()[m];
    if (map.sample_type == SampleType::kFloat32) continue;
    EngineMap engine{identifier(map.name, taken), map, roles[m], {}};
    taken.insert(lowerCase(engine.id));
    for (const PackageDifference& difference : map.differences) {
      engine.differences.push_back(engineDifference(map, difference));
    }
    maps.push_back(std::move(engine));
  }
  return maps;
}

std::vector<std::string> lossesOf(const Package& package, KeptBlocks kept, const std::string& recoded) {
  std::vector<std::string> losses;
  for (const PackageMap& map : package.maps()) {
    if (map.sample_type == SampleType::kFloat32) {
      losses.push_back(
          fmt::format("{}: left out, its samples are floats and textures of engines have 8 bits", map.name));
    } else if (map.sample_type == SampleType::kUint16) {
      losses.push_back(fmt::format("{}: rounded from 16 bits to 8", map.name));
    } else if (const std::optional<BlockFormat> format = decodedBlocks(map, kept)) {
      losses.push_back(
          fmt::format("{}: its {} blocks are decoded to PNG, {}", map.name, blockFormatName(*format), recoded));
    }
  }
  return losses;
}

void requireMaps(const Package& package, const std::vector<EngineMap>& maps) {
  if (!maps.empty()) return;
  throw InputError({package.directory().string(), "maps", "one of 8 or 16 bits", "floats alone",
                    "compress a capture with textures of integers"});
}

void writeNeutral(const Package& package, const EngineMap& map, const fs::path& folder, Progress& progress) {
  copyTexture(package, package::neutralTexture(map.map), folder / (map.id + "_neutral.png"), progress);
}

void writeTexture(const Package& package, const EngineMap& map, int texture, KeptBlocks kept, const fs::path& name,
                  Progress& progress) {
  const package::StoredTexture stored =
      texture < 0 ? package::neutralTexture(map.map) : package::differenceTexture(map.map, texture);
  if (!kept(map.map, texture)) return copyTexture(package, stored, name.string() + ".png", progress);
  progress.checkCancelled();
  package::copyFile(package, stored.file, name.string() + ".fzktx2");
}

StackLayout stackLayout(const Package& package, const EngineMap& map) {
  const int count = static_cast<int>(map.map.differences.size());
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    if (rows * map.map.height <= package::kMaxAtlasSide && columns * map.map.width <= package::kMaxAtlasSide) {
      return {columns, rows};
    }
  }
  throw InputError({package.directory().string(), map.map.name,
                    fmt::format("{} difference textures that fit into one image of {} x {}", count,
                                package::kMaxAtlasSide, package::kMaxAtlasSide),
                    fmt::format("{} x {} texels each", map.map.width, map.map.height),
                    "compress smaller textures, or with fewer --differences"});
}

void writeStack(const Package& package, const EngineMap& map, const fs::path& folder, Progress& progress) {
  copyTextures(package, differencesOf(map), stackLayout(package, map).columns, folder / (map.id + "_differences.png"),
               progress);
}

std::vector<int> usedSets(const std::vector<EngineMap>& maps) {
  std::set<int> sets;
  for (const EngineMap& map : maps) sets.insert(map.map.weight_set);
  return {sets.begin(), sets.end()};
}

void writeWeights(const Package& package, const std::vector<EngineMap>& maps, const fs::path& folder,
                  Progress& progress) {
  for (const int set : usedSets(maps)) {
    const PackageWeights& weights = package.weightSets()[static_cast<std::size_t>(set)];
    for (std::size_t f = 0; f < weights.files.size(); ++f) {
      const image::ImageShape shape = package::atlasShape(weights, package.differences(), static_cast<int>(f));
      copyTexture(package, {weights.files[f], std::nullopt, shape}, folder / fmt::format("weights_{}_{}.png", set, f),
                  progress);
    }
  }
}

std::string literal(double value) {
  std::string text = fmt::format("{:.12f}", value);  // no exponents: not every shading language has them
  while (text.ends_with('0') && !text.ends_with(".0")) text.pop_back();
  return text;
}

std::string literal(const std::string& type, const std::array<double, 4>& values) {
  return fmt::format("{}({}, {}, {}, {})", type, literal(values[0]), literal(values[1]), literal(values[2]),
                     literal(values[3]));
}

std::array<double, 4> fourOf(const std::vector<double>& values, std::size_t file) {
  std::array<double, 4> four{};
  for (std::size_t c = 0; c < 4 && 4 * file + c < values.size(); ++c) four[c] = values[4 * file + c];
  return four;
}

std::string swizzled(const std::string& type, const std::string& sample, int channels,
                     std::optional<BlockFormat> blocks) {
  if (channels == 2 && blocks == BlockFormat::kBc5) return fmt::format("{}({}.rg, 0.0, 0.0)", type, sample);
  switch (channels) {
    case 1:
      return fmt::format("{}({}.r, 0.0, 0.0, 0.0)", type, sample);
    case 2:
      return fmt::format("{}({}.ra, 0.0, 0.0)", type, sample);
    default:
      return sample;
  }
}

}  // namespace facezip::exporting
