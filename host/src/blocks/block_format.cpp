#include "blocks/block_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>

#include "facezip/block_size.hpp"
#include "facezip/error.hpp"

namespace facezip::blocks {
namespace {

using enum BlockFormat;

constexpr BlockFormatInfo astc(BlockFormat format, std::string_view name, int width, int height, std::uint32_t vk) {
  return {format, name, width, height, 16, 4, vk, vk + 1, 0, 0};
}

constexpr std::array kFormats = {
    BlockFormatInfo{kBc1, "bc1", 4, 4, 8, 3, 131, 132, 71, 72},
    BlockFormatInfo{kBc4, "bc4", 4, 4, 8, 1, 139, 0, 80, 0},
    BlockFormatInfo{kBc5, "bc5", 4, 4, 16, 2, 141, 0, 83, 0},
    BlockFormatInfo{kBc7, "bc7", 4, 4, 16, 4, 145, 146, 98, 99},
    astc(kAstc4x4, "astc-4x4", 4, 4, 157),
    astc(kAstc5x4, "astc-5x4", 5, 4, 159),
    astc(kAstc5x5, "astc-5x5", 5, 5, 161),
    astc(kAstc6x5, "astc-6x5", 6, 5, 163),
    astc(kAstc6x6, "astc-6x6", 6, 6, 165),
    astc(kAstc8x5, "astc-8x5", 8, 5, 167),
    astc(kAstc8x6, "astc-8x6", 8, 6, 169),
    astc(kAstc8x8, "astc-8x8", 8, 8, 171),
    astc(kAstc10x5, "astc-10x5", 10, 5, 173),
    astc(kAstc10x6, "astc-10x6", 10, 6, 175),
    astc(kAstc10x8, "astc-10x8", 10, 8, 177),
    astc(kAstc10x10, "astc-10x10", 10, 10, 179),
    astc(kAstc12x10, "astc-12x10", 12, 10, 181),
    astc(kAstc12x12, "astc-12x12", 12, 12, 183),
};

}  // namespace

std::span<const BlockFormatInfo> blockFormats() { return kFormats; }

const BlockFormatInfo& infoOf(BlockFormat format) {
  const auto index = static_cast<std::size_t>(format);
  assert(index < kFormats.size() && kFormats[index].format == format);
  return kFormats[index];
}

bool isAstc(BlockFormat format) { return format >= kAstc4x4; }

int blockCount(int texels, int block_side) { return texels / block_side + (texels % block_side != 0 ? 1 : 0); }

std::size_t blockBytes(BlockFormat format, int width, int height) {
  const BlockFormatInfo& info = infoOf(format);
  return static_cast<std::size_t>(blockCount(width, info.block_width)) *
         static_cast<std::size_t>(blockCount(height, info.block_height)) * static_cast<std::size_t>(info.block_bytes);
}

BlockFormat formatFor(BlockFormat wanted, int channels) {
  if (wanted != BlockFormat::kBc1 && wanted != BlockFormat::kBc7) return wanted;
  if (channels <= 2) return channels == 1 ? BlockFormat::kBc4 : BlockFormat::kBc5;
  return channels == 4 ? BlockFormat::kBc7 : wanted;
}

void requireChannels(BlockFormat format, int channels) {
  const BlockFormatInfo& info = infoOf(format);
  if (channels >= 1 && channels <= info.max_channels) return;
  throw InputError({std::string(info.name), "", fmt::format("textures of at most {} channels", info.max_channels),
                    fmt::format("{}", channels), "choose another format: bc7 and the astc formats store up to 4"});
}

}  // namespace facezip::blocks

namespace facezip {

BlockSize blockSize(BlockFormat format) {
  const blocks::BlockFormatInfo& info = blocks::infoOf(format);
  return {info.block_width, info.block_height, info.block_bytes};
}

std::uint64_t blockTextureBytes(BlockFormat format, int width, int height) {
  return blocks::blockBytes(format, width, height);
}

std::string_view blockFormatName(BlockFormat format) { return blocks::infoOf(format).name; }

BlockFormat blockFormatOf(std::string_view name, std::string_view option) {
  const auto formats = blocks::blockFormats();
  const auto found = std::ranges::find(formats, name, &blocks::BlockFormatInfo::name);
  if (found != formats.end()) return found->format;
  throw InputError({std::string(option), "", "one of " + blockFormatNames(), std::string(name), ""});
}

std::string blockFormatNames() {
  std::string names;
  for (const blocks::BlockFormatInfo& info : blocks::blockFormats())
    names += fmt::format("{}{}", names.empty() ? "" : ", ", info.name);
  return names;
}

}  // namespace facezip
