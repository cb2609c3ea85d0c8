#include "export/texture_copy.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

namespace facezip::exporting {
namespace fs = std::filesystem;
namespace {

/// Reads a texture in bytes.
class ByteReader {
 public:
  ByteReader(const Package& package, const package::StoredTexture& texture) : reader_(package.folder(), texture) {}

  /// Row `row` into `out`, width x channels bytes. Rows in rising order.
  void readRow(int row, std::span<std::byte> out) {
    if (reader_.shape().type == SampleType::kUint8) return reader_.readRows(row, row + 1, out);
    codes_.resize(reader_.shape().rowBytes());
    reader_.readRows(row, row + 1, codes_);
    for (std::size_t i = 0; i < out.size(); ++i) {
      std::uint16_t code = 0;
      std::memcpy(&code, codes_.data() + 2 * i, 2);
      out[i] = static_cast<std::byte>((code + 128u) / 257u);
    }
  }

 private:
  package::TextureReader reader_;
  std::vector<std::byte> codes_;
};

}  // namespace

void copyTextures(const Package& package, const std::vector<package::StoredTexture>& textures, int columns,
                  const fs::path& to, Progress& progress) {
  const image::ImageShape& one = textures.front().shape;
  const auto in_a_row = static_cast<std::size_t>(columns);
  const int rows_of_textures = static_cast<int>((textures.size() + in_a_row - 1) / in_a_row);
  const image::ImageShape shape{columns * one.width, rows_of_textures * one.height, one.channels, SampleType::kUint8};
  image::ImageWriter writer(to, shape);
  progress.stage("writing " + to.filename().string(), static_cast<std::size_t>(shape.height));
  const std::size_t bytes = shape.rowBytes() / in_a_row;
  for (std::size_t first = 0; first < textures.size(); first += in_a_row) {
    std::vector<ByteReader> readers;
    for (std::size_t i = first; i < std::min(first + in_a_row, textures.size()); ++i) {
      readers.emplace_back(package, textures[i]);
    }
    std::vector<std::byte> row(shape.rowBytes());
    for (int y = 0; y < one.height; ++y) {
      progress.checkCancelled();
      for (std::size_t i = 0; i < readers.size(); ++i) readers[i].readRow(y, std::span(row).subspan(i * bytes, bytes));
      writer.writeRows(row, 1);
      progress.advance(first / in_a_row * static_cast<std::size_t>(one.height) + static_cast<std::size_t>(y) + 1);
    }
  }
  writer.close();
}

void copyTexture(const Package& package, const package::StoredTexture& texture, const fs::path& to,
                 Progress& progress) {
  copyTextures(package, {texture}, 1, to, progress);
}

}  // namespace facezip::exporting
