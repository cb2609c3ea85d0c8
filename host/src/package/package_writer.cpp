#include "package/package_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include "facezip/version.hpp"
#include "image/image_file.hpp"
#include "io/staged_directory.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"
#include "package/weight_atlas.hpp"

namespace facezip::package {
namespace fs = std::filesystem;
namespace {

/// File names and atlas layout of one set of weights. Its grid is that of the first map that uses it, which names the
/// folder too where there are several sets: the set that all maps share belongs to none of them.
void completeWeights(PackageDescription& description, int set) {
  PackageWeights& weights = description.weights[static_cast<std::size_t>(set)];
  const auto map = std::find_if(description.maps.begin(), description.maps.end(),
                                [set](const PackageMap& m) { return m.weight_set == set; });
  if (map == description.maps.end()) return;  // refused with the rest of the description
  const std::string folder = description.weights.size() == 1 ? "" : map->name + "/";
  weights.files.clear();
  for (int file = 0; 4 * file < description.differences; ++file) {
    weights.files.push_back(folder + (file == 0 ? "weights.png" : fmt::format("weights_{}.png", file)));
  }
  if (map->weight_scale < 1 || description.expressions.empty()) return;
  weights.tile_width = weightCells(map->width, map->weight_scale);
  weights.tile_height = weightCells(map->height, map->weight_scale);
  arrangeAtlas(weights, static_cast<int>(description.expressions.size()));
}

/// File names, atlas layouts and generator of what the caller described.
PackageDescription complete(PackageDescription description) {
  description.generator = "facezip " FACEZIP_VERSION;
  for (int set = 0; set < static_cast<int>(description.weights.size()); ++set) completeWeights(description, set);
  for (PackageMap& map : description.maps) {
    const char* image = map.sample_type == SampleType::kFloat32 ? "exr" : "png";
    map.neutral_file = fmt::format("{}/neutral.{}", map.name, map.neutral_format ? "ktx2" : image);
    for (std::size_t i = 0; i < map.differences.size(); ++i) {
      PackageDifference& difference = map.differences[i];
      difference.file = fmt::format("{}/difference_{}.{}", map.name, i, difference.format ? "ktx2" : "png");
    }
  }
  return description;
}

}  // namespace

struct PackageWriter::Images {
  /// Textures in blocks have no writer here.
  struct Map {
    std::optional<image::ImageWriter> neutral;
    std::vector<std::optional<image::ImageWriter>> differences;
  };
  std::vector<Map> maps;
  std::vector<char> weights_written;  // per set; not vector<bool>, whose elements threads cannot set at once
};

// What is written is what parsePackageJson reads back: a package that could not be opened is refused here.
PackageWriter::PackageWriter(PackageDescription description, fs::path directory)
    : description_(parsePackageJson(packageJson(complete(std::move(description))), kDescriptionFile)),
      directory_(std::move(directory)),
      images_(std::make_unique<Images>()) {
  images_->weights_written.resize(description_.weights.size());
  for (const PackageMap& map : description_.maps) {
    io::createDirectories(directory_ / map.name);
    Images::Map& images = images_->maps.emplace_back();
    if (!map.neutral_format) {
      images.neutral.emplace(directory_ / map.neutral_file, neutralShape(map), map.colour_space);
    }
    for (const PackageDifference& difference : map.differences) {
      std::optional<image::ImageWriter>& writer = images.differences.emplace_back();
      if (!difference.format) writer.emplace(directory_ / difference.file, differenceShape(map));
    }
  }
}

PackageWriter::~PackageWriter() = default;

void PackageWriter::writeNeutralRows(int map, std::span<const std::byte> rows, int row_count) {
  images_->maps[static_cast<std::size_t>(map)].neutral->writeRows(rows, row_count);
}

void PackageWriter::writeDifferenceRows(int map, int difference, std::span<const std::byte> codes, int row_count) {
  images_->maps[static_cast<std::size_t>(map)].differences[static_cast<std::size_t>(difference)]->writeRows(codes,
                                                                                                            row_count);
}

void PackageWriter::writeWeights(int set, std::span<const std::byte> codes) {
  char& written = images_->weights_written[static_cast<std::size_t>(set)];
  assert(!written);
  writeWeightAtlas(description_, set, directory_, codes);
  written = true;
}

void PackageWriter::finish() {
  assert(std::ranges::all_of(images_->weights_written, [](char written) { return written != 0; }));
  for (Images::Map& map : images_->maps) {
    if (map.neutral) map.neutral->close();
    for (std::optional<image::ImageWriter>& difference : map.differences) {
      if (difference) difference->close();
    }
  }
  io::writeTextFile(directory_ / kDescriptionFile, packageJson(description_));
}

}  // namespace facezip::package
