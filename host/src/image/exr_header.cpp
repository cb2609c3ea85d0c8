#include "image/exr_header.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "facezip/error.hpp"
#include "io/file_at.hpp"

namespace facezip::image {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kBeforeAttributes = 8;  // magic number and version

/// Position behind the text that ends with 0 at or after `begin`; 0 where there is none.
std::size_t behindText(const std::vector<char>& bytes, std::size_t begin) {
  const auto end = std::find(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.end(), '\0');
  return end == bytes.end() ? 0 : static_cast<std::size_t>(end - bytes.begin()) + 1;
}

/// Attributes are a name, a type, a size in 4 bytes, and as much data; an empty name ends them.
bool attributesEnd(const std::vector<char>& bytes) {
  std::size_t at = kBeforeAttributes;
  while (at < bytes.size()) {
    if (bytes[at] == '\0') return true;
    at = behindText(bytes, at);
    if (at == 0) return false;
    at = behindText(bytes, at);
    if (at == 0 || bytes.size() - at < 4) return false;
    std::uint32_t size = 0;  // little-endian, as every device today
    std::memcpy(&size, &bytes[at], sizeof(size));
    at += sizeof(size);
    if (size > bytes.size() - at) return false;
    at += size;
  }
  return false;
}

}  // namespace

void requireExrHeader(const InputFile& file, const std::filesystem::path& path) {
  std::vector<char> bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(file.size(), kMostBytes)));
  const std::string fault = io::readAt(file.descriptor(), 0, std::as_writable_bytes(std::span(bytes)));
  if (!fault.empty()) throw InputError({path.string(), "", "an EXR file", fault, ""});
  if (!attributesEnd(bytes)) {
    throw InputError({path.string(), "", "an EXR file whose attributes end within its first MiB", "none", ""});
  }
}

}  // namespace facezip::image
