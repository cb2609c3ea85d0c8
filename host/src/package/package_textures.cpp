#include "package/package_textures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>

#include "io/counts.hpp"
#include "package/package_files.hpp"

namespace facezip::package {
namespace {

constexpr float kSixteenBits = 257.0f;  // of a code of 8

bool decodesToCodes(BlockFormat format) { return format == BlockFormat::kBc7 || format == BlockFormat::kBc1; }

std::string describe(const blocks::BlockTexture& texture) {
  return fmt::format("{} x {} texels in {}{}", texture.width, texture.height, blockFormatName(texture.format),
                     texture.srgb ? ", sRGB" : "");
}

void store(std::span<const float> codes, image::SampleType type, std::span<std::byte> out) {
  if (type == image::SampleType::kUint8) {
    for (std::size_t s = 0; s < codes.size(); ++s) out[s] = static_cast<std::byte>(codes[s] + 0.5f);
    return;
  }
  for (std::size_t s = 0; s < codes.size(); ++s) {
    const auto wide = static_cast<std::uint16_t>(codes[s] * kSixteenBits + 0.5f);
    std::memcpy(&out[2 * s], &wide, sizeof(wide));
  }
}

}  // namespace

// Samplers must give what is blended: codes, with no curve undone.
blocks::TextureFileReader openBlocks(const io::Folder& folder, const StoredTexture& texture) {
  InputFile opened = folder.open(texture.file, "a KTX2 texture", "the package is damaged: write it again");
  const std::filesystem::path path = folder.path() / texture.file;
  blocks::TextureFileReader reader(path, std::move(opened));
  const blocks::BlockTexture& found = reader.texture();
  const blocks::BlockTexture expected{*texture.format, texture.shape.width, texture.shape.height, found.levels, false};
  if (found == expected) return reader;
  throw InputError({path.string(), "", describe(expected) + " (package.json)", describe(found),
                    "the package was changed: write it again"});
}

StoredTexture neutralTexture(const PackageMap& map) {
  StoredTexture texture{map.neutral_file, map.neutral_format, neutralShape(map)};
  if (texture.format && !decodesToCodes(*texture.format)) texture.shape.type = image::SampleType::kUint16;
  return texture;
}

int readBits(const PackageMap& map) {
  const auto needs_more = [](const PackageDifference& d) { return d.format && !decodesToCodes(*d.format); };
  return std::ranges::any_of(map.differences, needs_more) ? 16 : map.difference_bits;
}

StoredTexture differenceTexture(const PackageMap& map, int difference) {
  const PackageDifference& stored = map.differences[toSize(difference)];
  StoredTexture texture{stored.file, stored.format, differenceShape(map)};
  if (stored.format && readBits(map) == 16) texture.shape.type = image::SampleType::kUint16;
  return texture;
}

bool hasBlocks(const PackageMap& map) {
  const auto in_blocks = [](const PackageDifference& difference) { return difference.format.has_value(); };
  return map.neutral_format || std::ranges::any_of(map.differences, in_blocks);
}

std::uint64_t bytesInMemory(const StoredTexture& texture) {
  const image::ImageShape& shape = texture.shape;
  if (texture.format) return blocks::blockBytes(*texture.format, shape.width, shape.height);
  return toSize(shape.height) * shape.rowBytes();
}

std::uint64_t checkTexture(const io::Folder& folder, const StoredTexture& texture) {
  if (!texture.format) return checkImage(folder, texture.file, texture.shape);
  openBlocks(folder, texture);
  return folder.open(texture.file, "a KTX2 texture").size();
}

TextureReader::TextureReader(const io::Folder& folder, const StoredTexture& texture) : shape_(texture.shape) {
  if (texture.format) {
    blocks_ = std::make_unique<blocks::TextureFileReader>(openBlocks(folder, texture));
    decoder_ = blocks::makeBlockDecoder(*texture.format, shape_.channels);
  } else {
    image_ = std::make_unique<image::ImageReader>(openImage(folder, texture.file, shape_));
  }
}

void TextureReader::readRows(int begin, int end, std::span<std::byte> out) {
  assert(out.size() == toSize(end - begin) * shape_.rowBytes());
  if (image_) {
    image_->readRows(begin, end, out);
  } else {
    readBlocks(begin, end, out);
  }
}

void TextureReader::readBlocks(int begin, int end, std::span<std::byte> out) {
  const blocks::BlockTexture& texture = blocks_->texture();
  const int side = blocks::infoOf(texture.format).block_height;
  const int first = begin / side;
  const int behind = divideUp(end, side);
  block_rows_.resize(toSize(behind - first) * blocks::blockRowBytes(texture, 0));
  blocks_->readRows(0, first, behind, block_rows_);
  const int rows = std::min(behind * side, shape_.height) - first * side;
  const std::size_t row_samples = toSize(shape_.width, shape_.channels);
  texels_.resize(toSize(rows) * row_samples);
  decoder_->decode(shape_.width, rows, block_rows_, std::span(texels_));
  const auto wanted =
      std::span(texels_).subspan(toSize(begin - first * side) * row_samples, toSize(end - begin) * row_samples);
  store(wanted, shape_.type, out);
}

image::Image readTexture(const io::Folder& folder, const StoredTexture& texture) {
  TextureReader reader(folder, texture);
  image::Image image{texture.shape, {}};
  image.samples.resize(toSize(texture.shape.height) * texture.shape.rowBytes());
  reader.readRows(0, texture.shape.height, image.samples);
  return image;
}

}  // namespace facezip::package
