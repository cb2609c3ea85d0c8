// Writes textures of blocks for block_test.mjs: block_textures FOLDER. Of each texture NAME.ktx2, NAME.dds where that
// container holds it, and NAME.LEVEL.f32: what facezip decodes a level to, height x width x channels; and
// textures.json, the list of them.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "blocks/block_decoder.hpp"
#include "blocks/block_encoder.hpp"
#include "blocks/mip_chain.hpp"
#include "blocks/texture_file.hpp"
#include "facezip/device.hpp"
#include "photograph_like.hpp"

namespace {

namespace fs = std::filesystem;
using namespace facezip;
using namespace facezip::blocks;

using Levels = std::vector<std::vector<std::byte>>;

struct Picture {
  std::string name;
  BlockTexture texture;
  int channels;
  Levels levels;
};

/// Blocks of a picture with edges and grain; the fourth channel is another one.
Levels codedPicture(const BlockTexture& texture, int channels, const Device& device) {
  const auto colours = test::photographLike(texture.width, texture.height);
  const auto others = test::photographLike(texture.width, texture.height, 7);
  std::vector<std::vector<float>> texels(static_cast<std::size_t>(texture.levels));
  for (std::size_t p = 0; p < colours.size() / 3; ++p) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
      texels[0].push_back(static_cast<float>(c < 3 ? colours[3 * p + c] : others[3 * p]));
    }
  }
  MipChain chain(texture.width, texture.height, channels, texture.levels,
                 [&](int level, int, std::span<const float> row, std::span<const float>) {
                   auto& rows = texels[static_cast<std::size_t>(level)];
                   rows.insert(rows.end(), row.begin(), row.end());
                 });
  chain.push(texels[0]);
  const auto encoder = makeBlockEncoder(device.context(), {texture.format, channels, Quality::kFast});
  Levels levels;
  for (int level = 0; level < texture.levels; ++level) {
    levels.emplace_back(levelBytes(texture, level));
    const TexelRows rows{.width = levelSide(texture.width, level),
                         .rows = levelSide(texture.height, level),
                         .channels = channels,
                         .samples = std::span<const float>(texels[static_cast<std::size_t>(level)]),
                         .weights = {}};
    encoder->encode(rows, levels.back(), {});
  }
  return levels;
}

/// Every pattern of bits is a block of BC1, BC4 and BC5, and nearly every one of BC7.
Levels anyBlocks(const BlockTexture& texture) {
  std::mt19937 random(3);
  Levels levels;
  for (int level = 0; level < texture.levels; ++level) {
    levels.emplace_back(levelBytes(texture, level));
    for (std::byte& byte : levels.back()) byte = static_cast<std::byte>(random());
    if (texture.format != BlockFormat::kBc7) continue;
    // Modes in equal shares: more of the first bits would be 1 otherwise.
    for (std::size_t block = 0; block < levels.back().size() / 16; ++block) {
      levels.back()[16 * block] = (levels.back()[16 * block] & std::byte{0xff} << (block % 8 + 1)) | std::byte{1}
                                                                                                         << block % 8;
    }
  }
  return levels;
}

void write(const fs::path& file, const Picture& picture) {
  TextureFileWriter writer(file, picture.texture);
  for (int level = 0; level < picture.texture.levels; ++level) {
    writer.append(level, picture.levels[static_cast<std::size_t>(level)]);
  }
  writer.close();
}

nlohmann::json save(const fs::path& folder, const Picture& picture) {
  const BlockTexture& texture = picture.texture;
  const BlockFormatInfo& info = infoOf(texture.format);
  write(folder / (picture.name + ".ktx2"), picture);
  if (!isAstc(texture.format)) write(folder / (picture.name + ".dds"), picture);
  for (int level = 0; level < texture.levels; ++level) {
    const int width = levelSide(texture.width, level), height = levelSide(texture.height, level);
    std::vector<float> decoded(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                               static_cast<std::size_t>(picture.channels));
    makeBlockDecoder(texture.format, picture.channels)
        ->decode(width, height, picture.levels[static_cast<std::size_t>(level)], std::span(decoded));
    std::ofstream file(folder / fmt::format("{}.{}.f32", picture.name, level), std::ios::binary);
    file.write(reinterpret_cast<const char*>(decoded.data()), static_cast<std::streamsize>(decoded.size() * 4));
  }
  return {{"name", picture.name},
          {"format", info.name},
          {"vkFormat", texture.srgb ? info.vk_srgb : info.vk_unorm},
          {"dxgiFormat", texture.srgb ? info.dxgi_srgb : info.dxgi_unorm},
          {"blockWidth", info.block_width},
          {"blockHeight", info.block_height},
          {"blockBytes", info.block_bytes},
          {"width", texture.width},
          {"height", texture.height},
          {"levels", texture.levels},
          {"channels", picture.channels},
          {"srgb", texture.srgb}};
}

Picture codedAs(const Device& device, BlockFormat format, int channels, bool srgb) {
  // WebGL takes BC textures of whole blocks alone; ASTC's sides have no such limit.
  const int width = isAstc(format) ? 53 : 64, height = isAstc(format) ? 38 : 48;
  const BlockTexture texture{format, width, height, mostLevels(width, height), srgb};
  return {fmt::format("{}_{}{}", infoOf(format).name, channels, srgb ? "_srgb" : ""), texture, channels,
          codedPicture(texture, channels, device)};
}

}  // namespace

int main(int, char** arguments) {
  const fs::path folder = arguments[1];
  fs::create_directories(folder);
  const Device device = openDevice();
  nlohmann::json list;
  for (const BlockFormatInfo& info : blockFormats()) {
    list.push_back(save(folder, codedAs(device, info.format, info.max_channels, false)));
    if (isAstc(info.format)) continue;
    const BlockTexture texture{info.format, 64, 48, mostLevels(64, 48)};
    list.push_back(save(folder, {fmt::format("{}_any", info.name), texture, info.max_channels, anyBlocks(texture)}));
  }
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc7, BlockFormat::kAstc6x6}) {
    list.push_back(save(folder, codedAs(device, format, 3, true)));
  }
  for (const int channels : {1, 2, 3})
    list.push_back(save(folder, codedAs(device, BlockFormat::kAstc4x4, channels, false)));
  std::ofstream(folder / "textures.json") << list.dump(1);
}
