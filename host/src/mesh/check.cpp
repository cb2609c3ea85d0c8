#include "facezip/check.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "io/read_file.hpp"
#include "mesh/package_mesh.hpp"
#include "package/guides.hpp"
#include "package/package_files.hpp"
#include "package/weight_atlas.hpp"

namespace facezip {
namespace fs = std::filesystem;
namespace {

std::vector<std::pair<std::string, image::ImageShape>> imagesOf(const PackageDescription& description) {
  std::vector<std::pair<std::string, image::ImageShape>> images;
  for (const PackageWeights& weights : description.weights) {
    for (std::size_t file = 0; file < weights.files.size(); ++file) {
      images.emplace_back(weights.files[file],
                          package::atlasShape(weights, description.differences, static_cast<int>(file)));
    }
  }
  for (const PackageMap& map : description.maps) {
    images.emplace_back(map.neutral_file, package::neutralShape(map));
    for (const PackageDifference& difference : map.differences) {
      images.emplace_back(difference.file, package::differenceShape(map));
    }
  }
  if (description.masks) images.emplace_back(description.masks->file, package::masksShape(*description.masks));
  return images;
}

void readAll(const fs::path& file, const image::ImageShape& shape, const Progress& progress) {
  constexpr int kRowsAtOnce = 64;
  image::ImageReader reader = package::openImage(file, shape);
  std::vector<std::byte> rows;
  for (int begin = 0; begin < shape.height; begin += kRowsAtOnce) {
    progress.checkCancelled();
    const int end = std::min(begin + kRowsAtOnce, shape.height);
    rows.resize(static_cast<std::size_t>(end - begin) * shape.rowBytes());
    reader.readRows(begin, end, rows);
  }
}

}  // namespace

void checkTexels(const Package& package, Progress& progress) {
  if (!package.description().mesh_file.empty()) {
    progress.stage("reading the mesh", 0);
    mesh::readPackageMesh(package);
  }
  const auto images = imagesOf(package.description());
  progress.stage("reading textures", 0);
  tbb::parallel_for(std::size_t{0}, images.size(),
                    [&](std::size_t i) { readAll(package.directory() / images[i].first, images[i].second, progress); });
}

}  // namespace facezip
