#include "scene/glb.hpp"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <cstring>
#include <optional>

#include "facezip/error.hpp"

namespace facezip::scene {
namespace {

constexpr std::size_t kWord = 4;
constexpr std::size_t kHeaderBytes = 3 * kWord;       // magic, version, length of all
constexpr std::size_t kChunkHeaderBytes = 2 * kWord;  // length of what follows, kind
constexpr std::uint32_t kMagic = 0x46546C67;          // "glTF"
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kJson = 0x4E4F534A;
constexpr std::uint32_t kBinary = 0x004E4942;

/// Little-endian, as glTF is on any machine.
std::uint32_t wordAt(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < kWord; ++i) word |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return word;
}

void appendWord(std::string& text, std::size_t word) {
  for (std::size_t i = 0; i < kWord; ++i) text += static_cast<char>(word >> (8 * i) & 0xff);
}

/// Takes the chunk of this kind off the front; none where another stands there.
std::optional<std::span<const std::byte>> takeChunk(std::span<const std::byte>& bytes, std::uint32_t kind) {
  if (bytes.size() < kChunkHeaderBytes || wordAt(bytes, kWord) != kind) return std::nullopt;
  const std::size_t length = wordAt(bytes, 0);
  if (length > bytes.size() - kChunkHeaderBytes) return std::nullopt;
  const std::span<const std::byte> chunk = bytes.subspan(kChunkHeaderBytes, length);
  bytes = bytes.subspan(kChunkHeaderBytes + length);
  return chunk;
}

}  // namespace

GlbParts splitGlb(std::span<const std::byte> bytes, const std::string& file) {
  const auto fail = [&](const std::string& got) {
    throw InputError(
        {file, "", "a whole binary glTF 2.0 file", got, "the file is truncated or damaged: write it again"});
  };
  const bool named = bytes.size() >= kHeaderBytes && wordAt(bytes, 0) == kMagic && wordAt(bytes, kWord) == kVersion &&
                     wordAt(bytes, 2 * kWord) == bytes.size();
  if (!named) fail(fmt::format("{} bytes that are none", bytes.size()));
  std::span<const std::byte> rest = bytes.subspan(kHeaderBytes);
  const auto json = takeChunk(rest, kJson);
  if (!json) fail("no JSON in it");
  const auto binary = takeChunk(rest, kBinary);
  if (!rest.empty()) fail(fmt::format("{} bytes behind its chunks of JSON and of binary data", rest.size()));
  return {std::string(reinterpret_cast<const char*>(json->data()), json->size()),
          binary.value_or(std::span<const std::byte>())};
}

std::string joinGlb(std::string json, std::span<const std::byte> binary) {
  while (json.size() % kWord != 0) json += ' ';
  const std::size_t padding = (kWord - binary.size() % kWord) % kWord;
  const std::size_t total = kHeaderBytes + 2 * kChunkHeaderBytes + json.size() + binary.size() + padding;
  assert(total <= UINT32_MAX);
  std::string glb;
  glb.reserve(total);
  for (const std::size_t word : {std::size_t{kMagic}, std::size_t{kVersion}, total, json.size(), std::size_t{kJson}}) {
    appendWord(glb, word);
  }
  glb += json;
  appendWord(glb, binary.size() + padding);
  appendWord(glb, kBinary);
  glb.append(reinterpret_cast<const char*>(binary.data()), binary.size());
  glb.append(padding, '\0');
  return glb;
}

}  // namespace facezip::scene
