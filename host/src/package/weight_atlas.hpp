// weight_atlas.hpp - the weight maps of all expressions in one image: tiles in row-major order, each inside a border
// that repeats its edge, so that a GPU's bilinear sampler never meets a neighbour.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "facezip/package.hpp"
#include "image/image_file.hpp"
#include "io/folder.hpp"

namespace facezip::package {

/// Sets columns and rows, near square, for `expressions` tiles of tile_width x tile_height.
/// Throws InputError when a side would pass 16384 cells.
void arrangeAtlas(PackageWeights& weights, int expressions);

/// Size of atlas file `file`, which holds weight channels 4 file up to 4 file + 3.
image::ImageShape atlasShape(const PackageWeights& weights, int differences, int file);

/// Writes all atlas files of weights[set], a row of tiles at a time.
/// codes  [N][tile_height][tile_width][C]
void writeWeightAtlas(const PackageDescription& description, int set, const std::filesystem::path& directory,
                      std::span<const std::byte> codes);

/// Receives one row of one weight map: `row` holds tile_width cells of `row_channels` codes, weight channels from
/// `first_channel` on.
using WeightRowVisitor = std::function<void(int expression, int cell_row, int first_channel, int row_channels,
                                            std::span<const std::byte> row)>;

/// Reads all atlas files of weights[set], a few rows at a time. Throws InputError for a damaged file.
void readWeightAtlas(const PackageDescription& description, int set, const io::Folder& folder,
                     const WeightRowVisitor& visit);

/// All codes of a set as writeWeightAtlas() takes them, [N][tile_height][tile_width][C]. Throws InputError.
void readWeightCodes(const PackageDescription& description, int set, const io::Folder& folder,
                     std::span<std::byte> codes);

}  // namespace facezip::package
