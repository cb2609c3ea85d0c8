#include "facezip/check.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "mesh/package_mesh.hpp"
#include "package/guides.hpp"
#include "package/package_files.hpp"
#include "package/weight_atlas.hpp"

namespace facezip {
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

/// Rows that take about a megabyte: enough for a decoder to be busy with.
int rowsAtOnce(const image::ImageShape& shape) {
  constexpr std::size_t kBytesAtOnce = std::size_t{1} << 20;
  return static_cast<int>(std::clamp<std::size_t>(kBytesAtOnce / shape.rowBytes(), 1, 64));
}

void readAll(const Package& package, const std::string& file, const image::ImageShape& shape,
             const Progress& progress) {
  const int rows_at_once = rowsAtOnce(shape);
  image::ImageReader reader = package::openImage(package.folder(), file, shape);
  std::vector<std::byte> rows;
  for (int begin = 0; begin < shape.height; begin += rows_at_once) {
    progress.checkCancelled();
    const int end = std::min(begin + rows_at_once, shape.height);
    rows.resize(static_cast<std::size_t>(end - begin) * shape.rowBytes());
    reader.readRows(begin, end, rows);
  }
}

/// What reading an image takes. EXR comes in blocks of up to 256 rows, packed and unpacked.
std::uint64_t bytesToRead(const image::ImageShape& shape) {
  const int block = shape.type == SampleType::kFloat32 ? 2 * 256 : 4;
  return (static_cast<std::uint64_t>(rowsAtOnce(shape)) + static_cast<std::uint64_t>(block)) * shape.rowBytes();
}

/// As many images side by side as fit.
int imagesAtOnce(const std::vector<std::pair<std::string, image::ImageShape>>& images, std::uint64_t memory_bytes) {
  std::uint64_t most = 1;
  for (const auto& [file, shape] : images) most = std::max(most, bytesToRead(shape));
  const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  return static_cast<int>(std::clamp<std::uint64_t>(memory_bytes / most, 1, threads));
}

}  // namespace

void checkMesh(const Package& package, std::uint64_t memory_bytes) {
  if (!package.description().mesh_file.empty()) mesh::readPackageMesh(package, memory_bytes);
}

void checkTexels(const Package& package, Progress& progress, std::uint64_t memory_bytes) {
  progress.stage("reading the mesh", 0);
  checkMesh(package, memory_bytes);
  const auto images = imagesOf(package.description());
  progress.stage("reading textures", 0);
  tbb::task_arena(imagesAtOnce(images, memory_bytes)).execute([&] {
    tbb::parallel_for(std::size_t{0}, images.size(),
                      [&](std::size_t i) { readAll(package, images[i].first, images[i].second, progress); });
  });
}

}  // namespace facezip
