#include "package/weight_atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <vector>

#include "io/counts.hpp"
#include "package/package_files.hpp"
#include "package/package_json.hpp"

namespace facezip::package {
namespace fs = std::filesystem;
namespace {

constexpr int kFileChannels = 4;

std::size_t size(int value) { return static_cast<std::size_t>(value); }

/// Copies weight channels [first, first + count) of one cell row into the atlas row that begins at `tile`, borders
/// included.
void copyRowWithBorder(std::span<const std::byte> row, int channels, int first, int count, int border,
                       std::byte* tile) {
  const int cells = static_cast<int>(row.size()) / channels;
  for (int x = -border; x < cells + border; ++x) {
    const int inside = std::clamp(x, 0, cells - 1);
    std::memcpy(tile + size(x + border) * size(count), row.data() + size(inside) * size(channels) + size(first),
                size(count));
  }
}

}  // namespace

void arrangeAtlas(PackageWeights& weights, int expressions) {
  const int width = weights.tile_width + 2 * weights.border;
  const int height = weights.tile_height + 2 * weights.border;
  const double square = std::sqrt(static_cast<double>(expressions) * height / width);
  weights.columns = std::clamp(static_cast<int>(std::ceil(square)), 1, std::max(1, kMaxAtlasSide / width));
  weights.columns = std::min(weights.columns, expressions);
  weights.rows = (expressions - 1) / weights.columns + 1;
  if (width > kMaxAtlasSide || weights.rows > kMaxAtlasSide / height) {
    throw InputError(
        {"", "weight atlas", fmt::format("at most {} cells along a side", kMaxAtlasSide),
         fmt::format("{} weight maps of {} x {} cells", expressions, weights.tile_width, weights.tile_height),
         "use a larger --weight-scale"});
  }
}

image::ImageShape atlasShape(const PackageWeights& weights, int differences, int file) {
  return {weights.columns * (weights.tile_width + 2 * weights.border),
          weights.rows * (weights.tile_height + 2 * weights.border),
          std::min(differences - kFileChannels * file, kFileChannels), image::SampleType::kUint8};
}

void writeWeightAtlas(const PackageDescription& description, int set, const fs::path& directory,
                      std::span<const std::byte> codes) {
  const PackageWeights& weights = description.weights[size(set)];
  const int expressions = static_cast<int>(description.expressions.size());
  const int channels = description.differences;
  const std::size_t row_bytes = size(weights.tile_width) * size(channels);
  assert(codes.size() == size(expressions) * size(weights.tile_height) * row_bytes);
  for (int file = 0; file < static_cast<int>(weights.files.size()); ++file) {
    const image::ImageShape shape = atlasShape(weights, channels, file);
    image::ImageWriter writer(directory / weights.files[size(file)], shape);
    const std::size_t tile_bytes = size(weights.tile_width + 2 * weights.border) * size(shape.channels);
    std::vector<std::byte> atlas_row(shape.rowBytes());
    for (int y = 0; y < shape.height; ++y) {
      const int tile_height = weights.tile_height + 2 * weights.border;
      const int cell_row = std::clamp(y % tile_height - weights.border, 0, weights.tile_height - 1);
      std::fill(atlas_row.begin(), atlas_row.end(), std::byte{0});
      for (int column = 0; column < weights.columns; ++column) {
        const int n = y / tile_height * weights.columns + column;
        if (n >= expressions) break;
        const std::size_t row = size(n) * size(weights.tile_height) + size(cell_row);
        copyRowWithBorder(codes.subspan(row * row_bytes, row_bytes), channels, kFileChannels * file, shape.channels,
                          weights.border, atlas_row.data() + size(column) * tile_bytes);
      }
      writer.writeRows(atlas_row, 1);
    }
    writer.close();
  }
}

namespace {

/// Visits rows of the atlas from `begin` on, without the borders of tiles.
void visitRows(const PackageWeights& weights, int expressions, int file, const image::ImageShape& shape, int begin,
               std::span<const std::byte> rows, const WeightRowVisitor& visit) {
  const int tile_height = weights.tile_height + 2 * weights.border;
  const std::size_t tile_bytes = size(weights.tile_width + 2 * weights.border) * size(shape.channels);
  for (std::size_t r = 0; r * shape.rowBytes() < rows.size(); ++r) {
    const int y = begin + static_cast<int>(r);
    const int cell_row = y % tile_height - weights.border;
    if (cell_row < 0 || cell_row >= weights.tile_height) continue;
    for (int column = 0; column < weights.columns; ++column) {
      const int n = y / tile_height * weights.columns + column;
      if (n >= expressions) break;
      const std::size_t at =
          r * shape.rowBytes() + size(column) * tile_bytes + size(weights.border) * size(shape.channels);
      visit(n, cell_row, kFileChannels * file, shape.channels,
            rows.subspan(at, size(weights.tile_width) * size(shape.channels)));
    }
  }
}

}  // namespace

void readWeightAtlas(const PackageDescription& description, int set, const io::Folder& folder,
                     const WeightRowVisitor& visit) {
  constexpr std::size_t kBytesAtOnce = std::size_t{1} << 20;
  const PackageWeights& weights = description.weights[size(set)];
  const int expressions = static_cast<int>(description.expressions.size());
  for (int file = 0; file < static_cast<int>(weights.files.size()); ++file) {
    const image::ImageShape shape = atlasShape(weights, description.differences, file);
    image::ImageReader reader = openImage(folder, weights.files[size(file)], shape);
    const int rows_at_once = std::max(1, static_cast<int>(kBytesAtOnce / shape.rowBytes()));
    std::vector<std::byte> rows;
    for (int begin = 0; begin < shape.height; begin += rows_at_once) {
      const int end = std::min(begin + rows_at_once, shape.height);
      rows.resize(size(end - begin) * shape.rowBytes());
      reader.readRows(begin, end, rows);
      visitRows(weights, expressions, file, shape, begin, rows, visit);
    }
  }
}

void readWeightCodes(const PackageDescription& description, int set, const io::Folder& folder,
                     std::span<std::byte> codes) {
  const PackageWeights& weights = description.weights[toSize(set)];
  const auto textures = toSize(description.differences);
  const std::size_t cells = toSize(weights.tile_height, weights.tile_width);
  assert(codes.size() == description.expressions.size() * cells * textures);
  readWeightAtlas(
      description, set, folder,
      [&](int expression, int cell_row, int first_channel, int row_channels, std::span<const std::byte> row) {
        const std::size_t first = toSize(expression) * cells + toSize(cell_row, weights.tile_width);
        const auto channels = toSize(row_channels);
        for (std::size_t b = 0; b < row.size(); ++b) {
          codes[(first + b / channels) * textures + toSize(first_channel) + b % channels] = row[b];
        }
      });
}

}  // namespace facezip::package
