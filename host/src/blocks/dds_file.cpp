#include "blocks/dds_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <string>
#include <string_view>

namespace facezip::blocks {
namespace {

// Offsets of fields.
constexpr std::size_t kHeaderSize = 4;
constexpr std::size_t kHeight = 12;
constexpr std::size_t kWidth = 16;
constexpr std::size_t kDepth = 24;
constexpr std::size_t kLevels = 28;
constexpr std::size_t kPixelFormatSize = 76;
constexpr std::size_t kPixelFormatFlags = 80;
constexpr std::size_t kFourCc = 84;
constexpr std::size_t kCapabilities2 = 112;
constexpr std::size_t kDxgiFormat = 128;
constexpr std::size_t kDimension = 132;
constexpr std::size_t kMiscellaneous = 136;
constexpr std::size_t kArraySize = 140;
constexpr std::size_t kAlphaMode = 144;
constexpr std::size_t kHeaderBytes = 148;

constexpr std::uint32_t kFourCcFlag = 4;
constexpr std::uint32_t kTexture2d = 3;
constexpr std::uint32_t kCube = 4;           // of kMiscellaneous
constexpr std::uint32_t kPremultiplied = 2;  // of kAlphaMode, its lowest three bits
constexpr std::uint32_t kCubeOrVolume = 0x20fe00;

TextureInFile placeLevels(const BlockTexture& texture) {
  TextureInFile placed{texture, {}, kHeaderBytes};
  for (int level = 0; level < texture.levels; ++level) {
    placed.level_begins.push_back(placed.file_bytes);
    placed.file_bytes += levelBytes(texture, level);
  }
  return placed;
}

void setFormat(const HeaderChecks& checks, std::uint32_t number, BlockTexture& texture) {
  const auto formats = blockFormats();
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const BlockFormatInfo& info) {
    return number != 0 && (number == info.dxgi_unorm || number == info.dxgi_srgb);
  });
  checks.require(found != formats.end(), "dxgiFormat", "the number of bc1, bc4, bc5 or bc7", fmt::format("{}", number));
  texture.format = found->format;
  texture.srgb = number == found->dxgi_srgb;
}

}  // namespace

TextureInFile ddsLayout(const BlockTexture& texture) { return placeLevels(texture); }

FileHeader ddsHeader(const BlockTexture& texture) {
  const BlockFormatInfo& info = infoOf(texture.format);
  assert(!isAstc(texture.format));
  constexpr std::uint32_t kFlags = 0xa1007;  // capabilities, height, width, pixel format, levels, bytes of level 0
  constexpr std::uint32_t kMipmapped = 0x401008, kSingle = 0x1000;
  const auto word = [](auto value) { return static_cast<std::uint32_t>(value); };
  FileHeader header;
  header.addText("DDS ");
  header.addWord(124);  // bytes of the header
  header.addWord(kFlags);
  header.addWord(word(texture.height));
  header.addWord(word(texture.width));
  header.addWord(word(levelBytes(texture, 0)));
  header.addWord(0);  // depth
  header.addWord(word(texture.levels));
  header.addZeros(kPixelFormatSize - header.size());
  header.addWord(32);  // bytes of the pixel format
  header.addWord(kFourCcFlag);
  header.addText("DX10");
  header.addZeros(5 * 4);  // bits of channels
  header.addWord(texture.levels > 1 ? kMipmapped : kSingle);
  header.addZeros(kDxgiFormat - header.size());
  header.addWord(texture.srgb ? info.dxgi_srgb : info.dxgi_unorm);
  header.addWord(kTexture2d);
  header.addWord(0);
  header.addWord(1);  // textures
  header.addWord(0);  // what alpha is: not said
  assert(header.size() == kHeaderBytes);
  return header;
}

TextureInFile readDds(const std::filesystem::path& path, const InputFile& file) {
  const HeaderChecks checks(path);
  // Older headers are shorter.
  const std::size_t there = std::min<std::uintmax_t>(file.size(), kHeaderBytes);
  const FileHeader header(path, file, there < kDxgiFormat ? kDxgiFormat : there);
  checks.require(header.text(0, 4) == "DDS ", "", "a DDS file", "another");
  checks.requireEqual("dwSize", 124, header.word(kHeaderSize));
  checks.requireEqual("ddspf.dwSize", 32, header.word(kPixelFormatSize));
  checks.require((header.word(kPixelFormatFlags) & kFourCcFlag) != 0 && header.text(kFourCc, 4) == "DX10",
                 "ddspf.dwFourCC", "DX10", "another", "write the file with the DX10 header");
  checks.require(header.size() == kHeaderBytes, "", fmt::format("{} bytes before the blocks", kHeaderBytes),
                 "cut short", "the file is truncated: replace it");
  BlockTexture texture;
  setFormat(checks, header.word(kDxgiFormat), texture);
  checks.requireEqual("resourceDimension", kTexture2d, header.word(kDimension), "give a 2D texture");
  checks.require((header.word(kMiscellaneous) & kCube) == 0 && (header.word(kCapabilities2) & kCubeOrVolume) == 0,
                 "miscFlag", "a 2D texture", "a cube or a volume", "give a 2D texture");
  checks.requireEqual("arraySize", 1, header.word(kArraySize), "give a single texture");
  checks.require((header.word(kAlphaMode) & 7) != kPremultiplied, "miscFlags2", "straight alpha", "premultiplied", "");
  checks.require(header.word(kDepth) <= 1, "dwDepth", "0 or 1", fmt::format("{}", header.word(kDepth)));
  texture.width = checks.integer("dwWidth", header.word(kWidth), kLargestDdsSide);
  texture.height = checks.integer("dwHeight", header.word(kHeight), kLargestDdsSide);
  // 0 where there is no more than one level.
  texture.levels =
      checks.integer("dwMipMapCount", std::max(1u, header.word(kLevels)), mostLevels(texture.width, texture.height));
  TextureInFile placed = placeLevels(texture);
  checks.requireWhole(placed, file);
  return placed;
}

}  // namespace facezip::blocks
