#include "blocks/ktx2_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "facezip/version.hpp"

namespace facezip::blocks {
namespace {

constexpr std::string_view kIdentifier("\xabKTX 20\xbb\r\n\x1a\n", 12);
constexpr std::size_t kFixedBytes = 80;  // identifier, header and offsets
constexpr std::size_t kIndexEntryBytes = 24;
constexpr std::uint32_t kMostKeyBytes = 64 << 10;

// Of the Khronos data format specification.
constexpr std::uint32_t kPrimariesBt709 = 1;
constexpr std::uint32_t kTransferLinear = 1;
constexpr std::uint32_t kTransferSrgb = 2;
constexpr std::uint32_t kVersion13 = 2;
constexpr std::size_t kPrimariesOffset = 13;  // of the descriptor

std::size_t indexBytes(int levels) { return kIndexEntryBytes * static_cast<std::size_t>(levels); }

std::uint32_t colourModel(BlockFormat format) {
  if (isAstc(format)) return 162;
  return format == BlockFormat::kBc1   ? 128
         : format == BlockFormat::kBc4 ? 131
         : format == BlockFormat::kBc5 ? 132
                                       : 134;
}

/// All bits of a block, or those of one channel of BC5.
void addSample(std::uint32_t first_bit, std::uint32_t bits, std::uint32_t channel, FileHeader& descriptor) {
  descriptor.addWord(first_bit | (bits - 1) << 16 | channel << 24);
  descriptor.addWord(0);            // position in the block
  descriptor.addWord(0);            // the value that is 0
  descriptor.addWord(0xffffffffu);  // and the one that is 1
}

/// The descriptor that the specification gives for the texture's VkFormat.
FileHeader dataFormatDescriptor(const BlockTexture& texture) {
  const BlockFormatInfo& info = infoOf(texture.format);
  const std::uint32_t samples = texture.format == BlockFormat::kBc5 ? 2 : 1;
  const auto block_bytes = static_cast<std::uint32_t>(info.block_bytes);
  const std::uint32_t size = 24 + 16 * samples;
  FileHeader descriptor;
  descriptor.addWord(4 + size);
  descriptor.addWord(0);  // Khronos' basic descriptor
  descriptor.addWord(kVersion13 | size << 16);
  descriptor.addWord(colourModel(texture.format) | (texture.srgb ? kPrimariesBt709 : 0) << 8 |
                     (texture.srgb ? kTransferSrgb : kTransferLinear) << 16);
  descriptor.addWord(static_cast<std::uint32_t>(info.block_width - 1) |
                     static_cast<std::uint32_t>(info.block_height - 1) << 8);
  descriptor.addWord(block_bytes);
  descriptor.addWord(0);
  for (std::uint32_t s = 0; s < samples; ++s) addSample(64 * s, 8 * block_bytes / samples, s, descriptor);
  return descriptor;
}

/// Keys in the order of their bytes, as the specification wants it.
FileHeader keysAndValues() {
  using namespace std::string_literals;
  FileHeader keys;
  for (const std::string& entry : {"KTXorientation\0rd\0"s, "KTXwriter\0facezip "s + FACEZIP_VERSION + '\0'}) {
    keys.addWord(static_cast<std::uint32_t>(entry.size()));
    keys.addText(entry);
    keys.alignTo(4);
  }
  return keys;
}

TextureInFile placeLevels(const BlockTexture& texture, std::size_t header_bytes) {
  // The least common multiple of 4 and a block of 8 or 16 bytes.
  const auto step = static_cast<std::uint64_t>(infoOf(texture.format).block_bytes);
  TextureInFile placed{texture, std::vector<std::uint64_t>(static_cast<std::size_t>(texture.levels)), header_bytes};
  for (int level = texture.levels - 1; level >= 0; --level) {
    const std::uint64_t begin = (placed.file_bytes + step - 1) / step * step;
    placed.level_begins[static_cast<std::size_t>(level)] = begin;
    placed.file_bytes = begin + levelBytes(texture, level);
  }
  return placed;
}

BlockTexture readFields(const HeaderChecks& checks, const FileHeader& header) {
  checks.require(header.text(0, kIdentifier.size()) == kIdentifier, "", "a KTX2 file", "another", "");
  // Before the format: files for transcoders have none.
  checks.require(header.word(44) == 0, "supercompressionScheme", "0 (none)", fmt::format("{}", header.word(44)),
                 "write the file without supercompression");
  BlockTexture texture;
  const std::uint32_t number = header.word(12);
  const auto formats = blockFormats();
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const BlockFormatInfo& info) {
    return number != 0 && (number == info.vk_unorm || number == info.vk_srgb);
  });
  checks.require(found != formats.end(), "vkFormat", "the number of one of " + blockFormatNames(),
                 fmt::format("{}", number));
  texture.format = found->format;
  texture.srgb = number == found->vk_srgb;
  checks.requireEqual("typeSize", 1, header.word(16));
  texture.width = checks.integer("pixelWidth", header.word(20), kLargestKtx2Side);
  texture.height = checks.integer("pixelHeight", header.word(24), kLargestKtx2Side);
  checks.requireEqual("pixelDepth", 0, header.word(28), "give a 2D texture");
  checks.requireEqual("layerCount", 0, header.word(32), "give a 2D texture");
  checks.requireEqual("faceCount", 1, header.word(36), "give a 2D texture");
  texture.levels = checks.integer("levelCount", header.word(40), mostLevels(texture.width, texture.height));
  return texture;
}

/// Where sections begin, of which all but the length of the keys is known. Returns where they end.
std::size_t checkSections(const HeaderChecks& checks, const FileHeader& header, const BlockTexture& texture) {
  const std::size_t descriptor = kFixedBytes + indexBytes(texture.levels);
  const std::size_t keys = descriptor + dataFormatDescriptor(texture).size();
  const std::uint32_t key_bytes = header.word(60);
  checks.requireEqual("dfdByteOffset", descriptor, header.word(48));
  checks.requireEqual("dfdByteLength", keys - descriptor, header.word(52));
  checks.requireEqual("kvdByteOffset", key_bytes == 0 ? 0 : keys, header.word(56));
  checks.require(key_bytes <= kMostKeyBytes, "kvdByteLength", fmt::format("at most {}", kMostKeyBytes),
                 fmt::format("{}", key_bytes));
  checks.requireEqual("sgdByteOffset", 0, header.longWord(64));
  checks.requireEqual("sgdByteLength", 0, header.longWord(72));
  return keys + key_bytes;
}

void checkIndex(const HeaderChecks& checks, const FileHeader& header, const TextureInFile& placed) {
  for (int level = 0; level < placed.texture.levels; ++level) {
    const std::size_t at = kFixedBytes + indexBytes(level);
    const std::string item = fmt::format("level {}: ", level);
    const std::size_t bytes = levelBytes(placed.texture, level);
    checks.requireEqual(item + "byteOffset", placed.level_begins[static_cast<std::size_t>(level)], header.longWord(at));
    checks.requireEqual(item + "byteLength", bytes, header.longWord(at + 8));
    checks.requireEqual(item + "uncompressedByteLength", bytes, header.longWord(at + 16));
  }
}

/// All but the primaries, which say nothing of how blocks decode.
void checkDescriptor(const HeaderChecks& checks, const FileHeader& header, const BlockTexture& texture) {
  const FileHeader expected = dataFormatDescriptor(texture);
  const auto begin = header.bytes().subspan(kFixedBytes + indexBytes(texture.levels), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (i == kPrimariesOffset) continue;
    checks.require(begin[i] == expected.bytes()[i], fmt::format("data format descriptor, byte {}", i),
                   fmt::format("{} (straight alpha, what vkFormat says)", std::to_integer<int>(expected.bytes()[i])),
                   fmt::format("{}", std::to_integer<int>(begin[i])));
  }
}

void checkKey(const HeaderChecks& checks, std::string_view key, std::string_view value) {
  using namespace std::string_view_literals;
  if (key == "KTXorientation") {
    checks.require(value == "rd\0"sv || value == "rd"sv, std::string(key), "rd", "another",
                   "turn the texture: row 0 is the upper one");
  }
  if (key == "KTXswizzle") {
    checks.require(value == "rgba\0"sv || value == "rgba"sv, std::string(key), "rgba", "another",
                   "write the channels where they belong");
  }
}

void checkKeys(const HeaderChecks& checks, const FileHeader& header, std::size_t begin, std::size_t end) {
  const auto requireWhole = [&](bool good) {
    checks.require(good, "keys and values", "entries that fill their section", "another", "the file is damaged");
  };
  while (begin < end) {
    requireWhole(end - begin >= 4);
    const std::size_t size = header.word(begin);
    begin += 4;
    requireWhole(size <= end - begin);
    const std::string_view entry = header.text(begin, size);
    const std::size_t key_end = entry.find('\0');
    requireWhole(key_end != std::string_view::npos);
    checkKey(checks, entry.substr(0, key_end), entry.substr(key_end + 1));
    begin += (size + 3) / 4 * 4;
  }
  requireWhole(begin == end);
}

}  // namespace

TextureInFile ktx2Layout(const BlockTexture& texture) {
  return placeLevels(texture, kFixedBytes + indexBytes(texture.levels) + dataFormatDescriptor(texture).size() +
                                  keysAndValues().size());
}

FileHeader ktx2Header(const BlockTexture& texture) {
  const BlockFormatInfo& info = infoOf(texture.format);
  const TextureInFile placed = ktx2Layout(texture);
  const FileHeader descriptor = dataFormatDescriptor(texture);
  const FileHeader keys = keysAndValues();
  const std::size_t descriptor_begin = kFixedBytes + indexBytes(texture.levels);
  const auto word = [](auto value) { return static_cast<std::uint32_t>(value); };
  FileHeader header;
  header.addText(kIdentifier);
  header.addWord(texture.srgb ? info.vk_srgb : info.vk_unorm);
  header.addWord(1);  // typeSize
  header.addWord(word(texture.width));
  header.addWord(word(texture.height));
  header.addWord(0);  // pixelDepth
  header.addWord(0);  // layerCount
  header.addWord(1);  // faceCount
  header.addWord(word(texture.levels));
  header.addWord(0);  // supercompressionScheme
  header.addWord(word(descriptor_begin));
  header.addWord(word(descriptor.size()));
  header.addWord(word(descriptor_begin + descriptor.size()));
  header.addWord(word(keys.size()));
  header.addLongWord(0);  // global data of supercompression
  header.addLongWord(0);
  for (int level = 0; level < texture.levels; ++level) {
    header.addLongWord(placed.level_begins[static_cast<std::size_t>(level)]);
    header.addLongWord(levelBytes(texture, level));
    header.addLongWord(levelBytes(texture, level));
  }
  for (const FileHeader* section : {&descriptor, &keys}) header.addText(section->text(0, section->size()));
  return header;
}

TextureInFile readKtx2(const std::filesystem::path& path, const InputFile& file) {
  const HeaderChecks checks(path);
  const FileHeader fixed(path, file, kFixedBytes);
  const BlockTexture texture = readFields(checks, fixed);
  const std::size_t keys_end = checkSections(checks, fixed, texture);
  const FileHeader header(path, file, keys_end);
  TextureInFile placed = placeLevels(texture, keys_end);
  checkIndex(checks, header, placed);
  checkDescriptor(checks, header, texture);
  checkKeys(checks, header, keys_end - fixed.word(60), keys_end);
  checks.requireWhole(placed, file);
  return placed;
}

}  // namespace facezip::blocks
