#include "package/package_writer.hpp"

#include <fmt/format.h>

#include <cassert>
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

/// File names, atlas layout and generator of what the caller described.
PackageDescription complete(PackageDescription description) {
  description.generator = "facezip " FACEZIP_VERSION;
  PackageWeights& weights = description.weights;
  weights.files.clear();
  for (int file = 0; 4 * file < description.differences; ++file) {
    weights.files.push_back(file == 0 ? "weights.png" : fmt::format("weights_{}.png", file));
  }
  if (!description.maps.empty() && description.maps.front().weight_scale > 0 && !description.expressions.empty()) {
    const PackageMap& map = description.maps.front();
    weights.tile_width = weightCells(map.width, map.weight_scale);
    weights.tile_height = weightCells(map.height, map.weight_scale);
    arrangeAtlas(weights, static_cast<int>(description.expressions.size()));
  }
  for (PackageMap& map : description.maps) {
    map.neutral_file = map.name + (map.sample_type == SampleType::kFloat32 ? "/neutral.exr" : "/neutral.png");
    for (std::size_t i = 0; i < map.differences.size(); ++i) {
      map.differences[i].file = fmt::format("{}/difference_{}.png", map.name, i);
    }
  }
  return description;
}

}  // namespace

struct PackageWriter::Images {
  struct Map {
    image::ImageWriter neutral;
    std::vector<image::ImageWriter> differences;
  };
  std::vector<Map> maps;
  bool weights_written = false;
};

// What is written is what parsePackageJson reads back: a package that could not be opened is refused here.
PackageWriter::PackageWriter(PackageDescription description, fs::path directory)
    : description_(parsePackageJson(packageJson(complete(std::move(description))), kDescriptionFile)),
      directory_(std::move(directory)),
      images_(std::make_unique<Images>()) {
  for (const PackageMap& map : description_.maps) {
    io::createDirectories(directory_ / map.name);
    std::vector<image::ImageWriter> differences;
    for (const PackageDifference& difference : map.differences) {
      differences.emplace_back(directory_ / difference.file, differenceShape(map));
    }
    images_->maps.push_back({image::ImageWriter(directory_ / map.neutral_file, neutralShape(map), map.colour_space),
                             std::move(differences)});
  }
}

PackageWriter::~PackageWriter() = default;

void PackageWriter::writeNeutralRows(int map, std::span<const std::byte> rows, int row_count) {
  images_->maps[static_cast<std::size_t>(map)].neutral.writeRows(rows, row_count);
}

void PackageWriter::writeDifferenceRows(int map, int difference, std::span<const std::byte> codes, int row_count) {
  images_->maps[static_cast<std::size_t>(map)].differences[static_cast<std::size_t>(difference)].writeRows(codes,
                                                                                                           row_count);
}

void PackageWriter::writeWeights(std::span<const std::byte> codes) {
  assert(!images_->weights_written);
  writeWeightAtlas(description_, directory_, codes);
  images_->weights_written = true;
}

void PackageWriter::finish() {
  assert(images_->weights_written);
  for (Images::Map& map : images_->maps) {
    map.neutral.close();
    for (image::ImageWriter& difference : map.differences) difference.close();
  }
  io::writeTextFile(directory_ / kDescriptionFile, packageJson(description_));
}

}  // namespace facezip::package
