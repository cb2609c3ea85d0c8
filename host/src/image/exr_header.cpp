#include "image/exr_header.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "facezip/error.hpp"
#include "io/file_at.hpp"

namespace facezip::image {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kBeforeAttributes = 8;  // magic number and version

/// A second image has a header of its own.
constexpr std::uint32_t kSeveralImages = 0x1000;

std::uint32_t numberAt(const std::vector<char>& bytes, std::size_t at) {
  std::uint32_t number = 0;  // little-endian, as every device today
  std::memcpy(&number, &bytes[at], sizeof(number));
  return number;
}

/// Position behind the text that ends with 0 at or after `begin`; 0 where there is none.
std::size_t behindText(const std::vector<char>& bytes, std::size_t begin) {
  const auto end = std::find(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.end(), '\0');
  return end == bytes.end() ? 0 : static_cast<std::size_t>(end - bytes.begin()) + 1;
}

struct FixedSize {
  std::string_view type;
  std::size_t bytes;
};
/// Types whose readers take so much, whatever the attribute says: an attribute that says another size would have them
/// read the next ones from the wrong place.
constexpr FixedSize kFixedSizes[] = {{"box2f", 16},
                                     {"box2i", 16},
                                     {"chromaticities", 32},
                                     {"compression", 1},
                                     {"deepImageState", 1},
                                     {"double", 8},
                                     {"envmap", 1},
                                     {"float", 4},
                                     {"int", 4},
                                     {"keycode", 28},
                                     {"lineOrder", 1},
                                     {"m33d", 72},
                                     {"m33f", 36},
                                     {"m44d", 128},
                                     {"m44f", 64},
                                     {"rational", 8},
                                     {"tiledesc", 9},
                                     {"timecode", 8},
                                     {"v2d", 16},
                                     {"v2f", 8},
                                     {"v2i", 8},
                                     {"v3d", 24},
                                     {"v3f", 12},
                                     {"v3i", 12}};

/// What OpenEXR takes memory by when it opens an image: so many samples of a row, times rows that are packed together,
/// 256 by DWA and 32 at most by all others.
constexpr int kMostSide = 65536;
constexpr int kMostChannels = 4;
constexpr unsigned char kFirstDwa = 8;

/// Channels are a name and 16 bytes each; an empty name ends them, and the attribute.
bool channelsFill(const std::vector<char>& bytes, std::size_t begin, std::size_t end) {
  constexpr std::size_t kChannel = 16;
  std::size_t at = begin;
  for (int channels = 0; at < end && bytes[at] != '\0'; ++channels) {
    at = behindText(bytes, at);
    if (at == 0 || at > end || end - at < kChannel || channels == kMostChannels) return false;
    at += kChannel;
  }
  return at + 1 == end;
}

/// Width, height, and four bytes a pixel.
bool previewFills(const std::vector<char>& bytes, std::size_t begin, std::size_t size) {
  if (size < 8) return false;
  const std::uint64_t pixels = std::uint64_t{numberAt(bytes, begin)} * numberAt(bytes, begin + 4);
  return pixels <= kMostBytes && size == 8 + 4 * pixels;
}

/// Texts in a row, each behind its length.
bool textsFill(const std::vector<char>& bytes, std::size_t begin, std::size_t end) {
  std::size_t at = begin;
  while (end - at >= 4) {
    const std::size_t length = numberAt(bytes, at);
    at += 4;
    if (length > end - at) return false;
    at += length;
  }
  return at == end;
}

/// First and last column and row, of which a side has 1 to kMostSide.
bool windowIsBounded(const std::vector<char>& bytes, std::size_t begin) {
  for (const std::size_t axis : {0u, 4u}) {
    const auto first = static_cast<std::int32_t>(numberAt(bytes, begin + axis));
    const auto last = static_cast<std::int32_t>(numberAt(bytes, begin + 8 + axis));
    const std::int64_t side = std::int64_t{last} - first + 1;
    if (side < 1 || side > kMostSide) return false;
  }
  return true;
}

/// Whether what OpenEXR reads of an attribute is as much as it says.
bool fills(std::string_view type, const std::vector<char>& bytes, std::size_t begin, std::size_t size) {
  if (type == "chlist") return channelsFill(bytes, begin, begin + size);
  if (type == "preview") return previewFills(bytes, begin, size);
  if (type == "stringvector") return textsFill(bytes, begin, begin + size);
  if (type == "floatvector") return size % 4 == 0;
  const auto fixed = std::ranges::find(kFixedSizes, type, &FixedSize::type);
  return fixed == std::end(kFixedSizes) || fixed->bytes == size;
}

/// Attributes are a name, a type, a size in 4 bytes, and as much data; an empty name ends them. Whether they do, and
/// OpenEXR reads them as they say, and takes no more memory by them than the limits allow.
bool isBounded(const std::vector<char>& bytes) {
  std::size_t at = kBeforeAttributes;
  while (at < bytes.size()) {
    if (bytes[at] == '\0') return true;
    const std::size_t begin = at;
    const std::size_t type = behindText(bytes, at);
    if (type == 0) return false;
    at = behindText(bytes, type);
    if (at == 0 || bytes.size() - at < 4) return false;
    const std::uint32_t size = numberAt(bytes, at);
    at += sizeof(size);
    if (size > bytes.size() - at || !fills(&bytes[type], bytes, at, size)) return false;
    const std::string_view name = &bytes[begin];
    if (name == "dataWindow" && (size != 16 || !windowIsBounded(bytes, at))) return false;
    if (name == "compression" && (size != 1 || static_cast<unsigned char>(bytes[at]) >= kFirstDwa)) return false;
    at += size;
  }
  return false;
}

}  // namespace

void requireExrHeader(const InputFile& file, const std::filesystem::path& path) {
  std::vector<char> bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(file.size(), kMostBytes)));
  const std::string fault = io::readAt(file.descriptor(), 0, std::as_writable_bytes(std::span(bytes)));
  if (!fault.empty()) throw InputError({path.string(), "", "an EXR file", fault, ""});
  if (bytes.size() >= kBeforeAttributes && (numberAt(bytes, 4) & kSeveralImages) != 0) {
    throw InputError({path.string(), "", "an EXR file", "several images in one file", ""});
  }
  if (!isBounded(bytes)) {
    throw InputError({path.string(), "",
                      "an EXR file of up to 4 channels, 65536 texels a side and any compression but DWA, whose "
                      "attributes end within its first MiB",
                      "another, or a damaged one", "write the package again"});
  }
}

}  // namespace facezip::image
