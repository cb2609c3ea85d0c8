// map_textures.hpp - the textures of one map of a package, read from disk into a TextureRows.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "blend/blend.hpp"
#include "facezip/package.hpp"
#include "package/package_textures.hpp"

namespace facezip::blend {

/// The encoding and shape of a map's textures as the kernel wants them: differences in steps of the neutral's samples.
TextureShape textureShape(const PackageMap& map, int differences);

/// Rows of the textures of a map that are read at a time, a multiple of kTileRows.
int rowsAtOnce(const TextureShape& shape);

/// Opens neutral and differences of one map and streams their rows.
class MapReader {
 public:
  /// Throws InputError.
  MapReader(const Package& package, int map_index);

  /// Reads rows textures.begin() to textures.end() from disk into `textures`. Throws InputError, DeviceError.
  void load(TextureRows& textures);

 private:
  std::vector<package::TextureReader> textures_;   // neutral, then C differences
  std::vector<std::vector<std::byte>> row_bytes_;  // a few rows of each
};

/// Reads every set of weight maps onto the device of `context`.
std::vector<std::shared_ptr<WeightMaps>> loadWeightMaps(const Package& package, device::DeviceContext& context);

}  // namespace facezip::blend
