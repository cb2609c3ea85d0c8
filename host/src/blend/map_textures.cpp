#include "blend/map_textures.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "io/counts.hpp"
#include "package/package_textures.hpp"
#include "package/weight_atlas.hpp"

namespace facezip::blend {
namespace {

/// Bytes of rows read at a time: enough to spread over threads, small beside a map.
constexpr std::size_t kBytesAtOnce = std::size_t{16} << 20;
constexpr std::size_t kMostTileRows = 8;

}  // namespace

int rowsAtOnce(const TextureShape& shape) {
  return static_cast<int>(std::clamp<std::size_t>(kBytesAtOnce / shape.tilesBytes(), 1, kMostTileRows)) * kTileRows;
}

TextureShape textureShape(const PackageMap& map, int differences) {
  TextureShape shape;
  shape.width = map.width;
  shape.channels = map.channels;
  shape.differences = differences;
  shape.difference_bits = package::readBits(map);
  shape.sample_type = map.sample_type;
  shape.neutral_type = package::neutralTexture(map).shape.type;
  shape.weight_scale = map.weight_scale;
  const double step = 1.0 / static_cast<double>(image::unit255(shape.sample_type));
  // Blocks that decode to values between codes are read with 257 to a code.
  const double read_codes = shape.difference_bits > map.difference_bits ? 257.0 : 1.0;
  for (const PackageDifference& difference : map.differences) {
    for (std::size_t c = 0; c < difference.scale.size(); ++c) {
      shape.scale.push_back(static_cast<float>(difference.scale[c] * step / read_codes));
      // A whole number by the format's rule; the division leaves a rounding error that would make zero inexact.
      const double zero = difference.scale[c] > 0.0 ? std::round(-difference.offset[c] / difference.scale[c]) : 0.0;
      shape.zero.push_back(static_cast<float>(zero * read_codes));
    }
  }
  return shape;
}

MapReader::MapReader(const Package& package, int map_index) {
  const PackageMap& map = package.maps()[toSize(map_index)];
  textures_.emplace_back(package.folder(), package::neutralTexture(map));
  for (int i = 0; i < package.differences(); ++i) {
    textures_.emplace_back(package.folder(), package::differenceTexture(map, i));
  }
  row_bytes_.resize(textures_.size());
}

void MapReader::load(TextureRows& textures) {
  std::vector<std::span<const std::byte>> differences(textures_.size() - 1);
  const int most_rows = rowsAtOnce(textures.shape());
  for (int first = textures.begin(); first < textures.end(); first += most_rows) {
    const int rows = std::min(most_rows, textures.end() - first);
    tbb::parallel_for(std::size_t{0}, textures_.size(), [&](std::size_t i) {
      row_bytes_[i].resize(toSize(rows) * textures_[i].shape().rowBytes());
      textures_[i].readRows(first, first + rows, row_bytes_[i]);
    });
    for (std::size_t i = 0; i < differences.size(); ++i) differences[i] = row_bytes_[i + 1];
    textures.load(first, rows, row_bytes_[0], differences);
  }
}

namespace {

std::shared_ptr<WeightMaps> loadWeightSet(const Package& package, int set, device::DeviceContext& context) {
  const PackageWeights& weights = package.weightSets()[toSize(set)];
  const WeightCodes grid{weights.tile_width, weights.tile_height, static_cast<int>(package.expressions().size()),
                         weights.scale, weights.offset};
  std::vector<std::byte> codes(grid.codeBytes());
  package::readWeightAtlas(
      package.description(), set, package.folder(),
      [&](int expression, int cell_row, int first_channel, int row_channels, std::span<const std::byte> row) {
        const std::size_t first_cell = grid.cell(cell_row, 0);
        const std::size_t channels = toSize(row_channels);
        for (std::size_t b = 0; b < row.size(); ++b) {
          const int channel = first_channel + static_cast<int>(b % channels);
          codes[grid.codeIndex(expression, first_cell + b / channels, channel)] = row[b];
        }
      });
  return std::make_shared<WeightMaps>(context, grid, codes);
}

}  // namespace

std::vector<std::shared_ptr<WeightMaps>> loadWeightMaps(const Package& package, device::DeviceContext& context) {
  std::vector<std::shared_ptr<WeightMaps>> sets;
  for (int set = 0; set < static_cast<int>(package.weightSets().size()); ++set) {
    sets.push_back(loadWeightSet(package, set, context));
  }
  return sets;
}

}  // namespace facezip::blend
