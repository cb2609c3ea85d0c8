// blend_memory.hpp - what blending a package takes, on host and device together: known before it is taken.
#pragma once

#include <cstdint>

#include "facezip/package.hpp"

namespace facezip::blend {

/// All sets of weight maps, as WeightMaps keeps them and while they are read.
std::uint64_t weightBytes(const Package& package);

/// Rows of a map's textures on their way from disk into tiles (MapReader).
std::uint64_t stagingBytes(const PackageMap& map, int differences);

/// All textures of a map and a frame of it (TextureRows).
std::uint64_t textureBytes(const PackageMap& map, int differences);

/// A row of a map's tiles, and two frames of its rows: the least that BandBlender holds.
std::uint64_t bandBytes(const PackageMap& map, int differences);

/// What an image file takes that is open for writing: its encoder, and rows on their way.
std::uint64_t writerBytes(const PackageMap& map);

/// A Blender of the package, and what making it takes.
std::uint64_t blenderBytes(const Package& package);

}  // namespace facezip::blend
