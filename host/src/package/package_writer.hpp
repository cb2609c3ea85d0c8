// package_writer.hpp - writes a package band by band (docs/package_format.md).
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "facezip/package.hpp"

namespace facezip::package {

/// Writes the files of one package into a directory, package.json last. The directory should be a
/// io::StagedDirectory's, so that a reader sees the whole package or none; committing it is the caller's.
class PackageWriter {
 public:
  /// Creates every image; textures in blocks (those that have a format) are the caller's to write, under the names
  /// that description() gives them. From the caller come: name, expressions, differences (C), scale/offset of each set
  /// of weights, method_json and of each map name, width, height, channels, sample_type, colour_space, weight_set,
  /// weight_scale, metric_weight, difference_bits, formats of blocks and C differences with scale/offset. File names,
  /// atlas layouts and the generator are filled in here. Throws InputError for a description that Package::open would
  /// refuse, and when a weight atlas would pass 16384 cells along a side; OutputError.
  PackageWriter(PackageDescription description, std::filesystem::path directory);
  ~PackageWriter();

  /// The description with all fields filled in.
  const PackageDescription& description() const { return description_; }

  /// Writes the next rows of a map's neutral: interleaved samples of the map's type, no padding. Throws OutputError.
  void writeNeutralRows(int map, std::span<const std::byte> rows, int row_count);

  /// Writes the next rows of difference texture `difference`: codes of the map's difference_bits, 16-bit ones in the
  /// byte order of the host, channels interleaved, no padding. Throws OutputError.
  void writeDifferenceRows(int map, int difference, std::span<const std::byte> codes, int row_count);

  /// Writes all weight maps of one set, once. Sets may be written by several threads at once.
  /// codes  [N][tile_height][tile_width][C], of the set's own tile size
  void writeWeights(int set, std::span<const std::byte> codes);

  /// Closes the images and writes package.json. All rows and weights must have been written. Throws OutputError.
  void finish();

 private:
  struct Images;
  PackageDescription description_;
  std::filesystem::path directory_;
  std::unique_ptr<Images> images_;
};

/// Columns and rows of cells that a weight map needs at 1/s of width x height: ceil(width / s), ceil(height / s).
constexpr int weightCells(int texels, int weight_scale) { return (texels - 1) / weight_scale + 1; }

}  // namespace facezip::package
