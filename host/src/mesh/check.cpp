#include "facezip/check.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <vector>

#include "mesh/package_mesh.hpp"
#include "package/guides.hpp"
#include "package/package_textures.hpp"
#include "package/weight_atlas.hpp"

namespace facezip {
namespace {

std::vector<package::StoredTexture> texturesOf(const PackageDescription& description) {
  std::vector<package::StoredTexture> textures;
  for (const PackageWeights& weights : description.weights) {
    for (std::size_t file = 0; file < weights.files.size(); ++file) {
      textures.push_back({weights.files[file], std::nullopt,
                          package::atlasShape(weights, description.differences, static_cast<int>(file))});
    }
  }
  for (const PackageMap& map : description.maps) {
    textures.push_back(package::neutralTexture(map));
    for (int i = 0; i < description.differences; ++i) textures.push_back(package::differenceTexture(map, i));
  }
  if (description.parts) {
    for (const PackageMaterial& material : description.parts->materials) {
      if (!material.texture.empty()) {
        textures.push_back({material.texture, std::nullopt, package::textureShape(material)});
      }
    }
  }
  if (description.masks) {
    textures.push_back({description.masks->file, std::nullopt, package::masksShape(*description.masks)});
  }
  return textures;
}

/// Rows that take about a megabyte: enough for a decoder to be busy with.
int rowsAtOnce(const image::ImageShape& shape) {
  constexpr std::size_t kBytesAtOnce = std::size_t{1} << 20;
  return static_cast<int>(std::clamp<std::size_t>(kBytesAtOnce / shape.rowBytes(), 1, 64));
}

void readAll(const Package& package, const package::StoredTexture& texture, const Progress& progress) {
  const image::ImageShape& shape = texture.shape;
  const int rows_at_once = rowsAtOnce(shape);
  package::TextureReader reader(package.folder(), texture);
  std::vector<std::byte> rows;
  for (int begin = 0; begin < shape.height; begin += rows_at_once) {
    progress.checkCancelled();
    const int end = std::min(begin + rows_at_once, shape.height);
    rows.resize(static_cast<std::size_t>(end - begin) * shape.rowBytes());
    reader.readRows(begin, end, rows);
  }
}

/// What reading a texture takes. EXR comes in blocks of up to 256 rows, packed and unpacked; blocks of up to 12 rows
/// are decoded to floats of four channels.
std::uint64_t bytesToRead(const package::StoredTexture& texture) {
  const image::ImageShape& shape = texture.shape;
  const int block = texture.format                       ? 16 * (rowsAtOnce(shape) + 2 * 12)
                    : shape.type == SampleType::kFloat32 ? 2 * 256
                                                         : 4;
  return (static_cast<std::uint64_t>(rowsAtOnce(shape)) + static_cast<std::uint64_t>(block)) * shape.rowBytes();
}

/// As many textures side by side as fit.
int texturesAtOnce(const std::vector<package::StoredTexture>& textures, std::uint64_t memory_bytes) {
  std::uint64_t most = 1;
  for (const package::StoredTexture& texture : textures) most = std::max(most, bytesToRead(texture));
  const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  return static_cast<int>(std::clamp<std::uint64_t>(memory_bytes / most, 1, threads));
}

}  // namespace

void checkMesh(const Package& package, std::uint64_t memory_bytes) {
  const PackageDescription& description = package.description();
  if (description.mesh_file.empty()) return;
  const mesh::PackageMesh mesh = mesh::readPackageMesh(package, memory_bytes);
  if (description.parts) mesh::readPackageParts(package, mesh, memory_bytes);
}

void checkTexels(const Package& package, Progress& progress, std::uint64_t memory_bytes) {
  progress.stage("reading the mesh", 0);
  checkMesh(package, memory_bytes);
  const std::vector<package::StoredTexture> textures = texturesOf(package.description());
  progress.stage("reading textures", 0);
  tbb::task_arena(texturesAtOnce(textures, memory_bytes)).execute([&] {
    tbb::parallel_for(std::size_t{0}, textures.size(), [&](std::size_t i) { readAll(package, textures[i], progress); });
  });
}

}  // namespace facezip
