#include "blend/blend_memory.hpp"

#include <algorithm>

#include "blend/blend.hpp"
#include "blend/map_textures.hpp"
#include "blend/weight_blend.hpp"
#include "package/package_files.hpp"

namespace facezip::blend {
namespace {

/// A row of tiles of a frame, padded.
std::uint64_t frameTilesBytes(const TextureShape& shape) {
  return static_cast<std::uint64_t>(kTileRows * shape.tilesAcross()) * kTileWidth *
         static_cast<std::uint64_t>(shape.channels) * image::sampleBytes(shape.sample_type);
}

}  // namespace

std::uint64_t weightBytes(const Package& package) {
  std::uint64_t kept = 0, largest = 0;
  for (const PackageWeights& set : package.weightSets()) {
    const WeightCodes grid{set.tile_width, set.tile_height, static_cast<int>(package.expressions().size()), set.scale,
                           set.offset};
    const std::uint64_t floats = grid.blocks() * WeightCodes::kBlockCells * toSize(grid.channels() + 1) * sizeof(float);
    kept += grid.codeBytes() + floats;
    largest = std::max<std::uint64_t>(largest, grid.codeBytes());  // on the host, while a set is read
  }
  return kept + largest;
}

std::uint64_t stagingBytes(const PackageMap& map, int differences) {
  const TextureShape shape = textureShape(map, differences);
  const auto tile_rows = static_cast<std::uint64_t>(rowsAtOnce(shape) / kTileRows);
  return 2 * tile_rows * shape.tilesBytes();  // as they are in the files, and in tiles
}

std::uint64_t textureBytes(const PackageMap& map, int differences) {
  const TextureShape shape = textureShape(map, differences);
  const auto tile_rows = static_cast<std::uint64_t>((map.height + kTileRows - 1) / kTileRows);
  return tile_rows * (shape.tilesBytes() + frameTilesBytes(shape));
}

std::uint64_t bandBytes(const PackageMap& map, int differences) {
  const TextureShape shape = textureShape(map, differences);
  return shape.tilesBytes() + 2 * frameTilesBytes(shape);
}

std::uint64_t writerBytes(const PackageMap& map) {
  constexpr std::uint64_t kEncoder = std::uint64_t{1} << 19;
  constexpr std::uint64_t kRows = 32;  // EXR packs 16 at a time
  return kEncoder + kRows * package::neutralShape(map).rowBytes();
}

std::uint64_t blenderBytes(const Package& package) {
  std::uint64_t textures = 0, staging = 0;
  for (const PackageMap& map : package.maps()) {
    textures += textureBytes(map, package.differences());
    staging = std::max(staging, stagingBytes(map, package.differences()));
  }
  return weightBytes(package) + textures + staging;
}

}  // namespace facezip::blend
